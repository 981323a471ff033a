#pragma once

#include <cstdint>
#include <cstring>

namespace cloth {

/// Eight numbers in single precision, and what a comparison makes of them: -1 where it holds.
using EightFloats = float __attribute__((vector_size(32)));
using EightMasks = std::int32_t __attribute__((vector_size(32)));

// Goes through memcpy: the memory is aligned for one number.
inline EightFloats load_eight(const float* values) {
    EightFloats lanes;
    std::memcpy(&lanes, values, sizeof(lanes));
    return lanes;
}

/// A bit for each lane, the lowest one for the first.
inline unsigned bits_of(const EightMasks& mask) {
    const EightMasks bits = mask & EightMasks{1, 2, 4, 8, 16, 32, 64, 128};
    const auto four = __builtin_shufflevector(bits, bits, 0, 1, 2, 3) |
                      __builtin_shufflevector(bits, bits, 4, 5, 6, 7);
    const auto two = four | __builtin_shufflevector(four, four, 2, 3, 0, 1);
    return static_cast<unsigned>(two[0] | two[1]);
}

/// Calls visit(lane) for each bit.
template <typename Visit>
void for_each_lane(unsigned bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1) visit(static_cast<std::size_t>(__builtin_ctz(bits)));
}

}  // namespace cloth
