#define CLOTH_KERNELS avx512_bf16_kernels
#include "gnn/model/message_kernels.inl"
