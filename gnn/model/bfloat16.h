#pragma once

#include <cstdint>
#include <cstring>

namespace cloth {

/// What the engine's matrix products read; sums, LayerNorm and latents are float32 in both.
enum class Precision {
    float32,  ///< equal to LibTorch to 1e-5; the default
    bfloat16  ///< weights and activations rounded to 8 significant bits: half the memory for
              ///< weights, and faster where the processor has AVX512-BF16
};

/// The upper half of a float.
using Bfloat16 = std::uint16_t;

/// Rounds to nearest, ties to even; not a number stays that.
inline Bfloat16 to_bfloat16(float value) {
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    if (value != value) return static_cast<Bfloat16>(bits >> 16 | 0x40);
    return static_cast<Bfloat16>((bits + 0x7fff + (bits >> 16 & 1)) >> 16);
}

inline float to_float(Bfloat16 value) {
    const std::uint32_t bits = static_cast<std::uint32_t>(value) << 16;
    float result;
    std::memcpy(&result, &bits, sizeof result);
    return result;
}

}  // namespace cloth
