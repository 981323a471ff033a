#pragma once

#ifdef __AVX__
#include <immintrin.h>
#endif

#include <cstddef>
#include <cstdint>
#include <cstring>

// How vectors are returned differs without AVX; here they never are, as all of this is inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace cloth {

// Eight numbers that are computed with together. Eigen's arrays are four and four, and the
// processor waits where they are read as eight.
using EightFloats = float __attribute__((vector_size(32)));
using EightFlags = std::int32_t __attribute__((vector_size(32)));
using EightSets = std::uint32_t __attribute__((vector_size(32)));

template <class Vector, class Number>
Vector load_eight(const Number* values) {
    static_assert(sizeof(Vector) == 8 * sizeof(Number));
    Vector loaded;
    std::memcpy(&loaded, values, sizeof loaded);
    return loaded;
}

inline EightFloats load_eight(const float* values) {
    return load_eight<EightFloats>(values);
}

/// Where neither is a NaN.
inline EightFloats smaller(const EightFloats& a, const EightFloats& b) {
    return a < b ? a : b;
}

inline EightFloats larger(const EightFloats& a, const EightFloats& b) {
    return a > b ? a : b;
}

/// Bit k is set where flag k is.
inline unsigned bits(const EightFlags& flags) {
#ifdef __AVX__
    return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<const __m256&>(flags)));
#else
    unsigned set = 0;
    for (int k = 0; k < 8; ++k) set |= (flags[k] != 0 ? 1u : 0u) << k;
    return set;
#endif
}

/// Calls visit(lane) for each bit.
template <typename Visit>
void for_each_lane(unsigned bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1) visit(static_cast<std::size_t>(__builtin_ctz(bits)));
}

}  // namespace cloth
