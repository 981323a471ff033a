#pragma once

#ifdef __AVX__
#include <immintrin.h>
#endif

#include <cstdint>
#include <cstring>
#include <limits>

#include "data/core/types.h"

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

inline EightFloats load(const float* values) {
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

/// Eight boxes of a node of ClosestFaceTree, by axis.
using EightBounds = Eigen::Array<float, 8, 1>[3];

/// Squared distances of a point to boxes.
inline EightFloats box_distances(const EightBounds& low, const EightBounds& high,
                                 const Eigen::Vector3f& q) {
    EightFloats sum = {};
    for (int k = 0; k < 3; ++k) {
        const EightFloats below = load(low[k].data()) - q[k], above = q[k] - load(high[k].data());
        const EightFloats outside = larger(larger(below, above), EightFloats{});
        sum += outside * outside;
    }
    return sum;
}

/// Slab test of a ray from q with boxes: how far along it enters them, infinity: it does not.
/// @param inverse  1 / direction
inline EightFloats box_entries(const EightBounds& low, const EightBounds& high,
                               const Eigen::Vector3f& q, const Eigen::Vector3f& inverse,
                               float length) {
    EightFloats enter = {}, leave = enter + length;
    for (int k = 0; k < 3; ++k) {
        const EightFloats a = (load(low[k].data()) - q[k]) * inverse[k];
        const EightFloats b = (load(high[k].data()) - q[k]) * inverse[k];
        enter = larger(enter, smaller(a, b));
        leave = smaller(leave, larger(a, b));
    }
    return enter <= leave ? enter : EightFloats{} + std::numeric_limits<float>::infinity();
}

}  // namespace cloth
