#pragma once

#include "gnn/model/message_block.h"

namespace cloth {

/// The loops of message_block.h, once per instruction set. Panels (pack_panels) stand in for the
/// weights of the forward pass; scratch holds scratch_floats(...) numbers.
struct MessageKernels {
    void (*forward)(const MessageBlockWeights&, const MessageBlockRows&, float* out, float* sum,
                    float* scratch);
    void (*backward)(const MessageBlockWeights&, const MessageBlockRows&, const float* d_out,
                     const float* d_sum, const MessageBlockGradients&, float* scratch);
    void (*dense)(int rows, int in, int out, const float* x, const float* panels, const float* bias,
                  bool with_relu, float* y);
    void (*forward_bf16)(const MessageBlockWeights&, const MessageBlockRows&, float* out,
                         float* sum, float* scratch);
    void (*dense_bf16)(int rows, int in, int out, const float* x, const Bfloat16* panels,
                       const float* bias, bool with_relu, float* y, float* scratch);
};

/// Each is compiled with its own options, in a file of its own; call one only where the processor
/// has the instructions.
extern const MessageKernels portable_kernels;
#if defined(__x86_64__)
extern const MessageKernels avx2_kernels, avx512_kernels, avx512_bf16_kernels;
#endif

constexpr int kernel_lanes = 16;  ///< of the widest instructions: every width's divisor
constexpr int panel_width = 32;   ///< outputs of a panel; the last one may have 16
constexpr int tile_rows = 48;     ///< rows whose temporaries stay in cache

}  // namespace cloth
