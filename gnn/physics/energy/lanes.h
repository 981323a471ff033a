#pragma once

#include <cstring>
#include <type_traits>

namespace cloth {

using FloatLanes = float __attribute__((vector_size(16)));
using DoubleLanes = double __attribute__((vector_size(32)));

/// x, y, z and a spare lane, of one row of an array (n x 4).
template <class Real>
using Lanes = std::conditional_t<std::is_same_v<Real, float>, FloatLanes, DoubleLanes>;

// Loads and stores go through memcpy: the memory is aligned for one lane.

template <class Real>
inline Lanes<Real> load(const Real* p) {
    Lanes<Real> v;
    std::memcpy(&v, p, sizeof(v));
    return v;
}

template <class Real>
inline void store(Real* p, const Lanes<Real>& v) {
    std::memcpy(p, &v, sizeof(v));
}

/// The same in double precision.
template <class V>
inline DoubleLanes widened(const V& v) {
    return __builtin_convertvector(v, DoubleLanes);
}

inline double sum(const DoubleLanes& v) {
    return (v[0] + v[1]) + (v[2] + v[3]);
}

/// Rows become columns.
inline void transpose(DoubleLanes (&rows)[4]) {
    const DoubleLanes low01 = __builtin_shufflevector(rows[0], rows[1], 0, 4, 2, 6);
    const DoubleLanes high01 = __builtin_shufflevector(rows[0], rows[1], 1, 5, 3, 7);
    const DoubleLanes low23 = __builtin_shufflevector(rows[2], rows[3], 0, 4, 2, 6);
    const DoubleLanes high23 = __builtin_shufflevector(rows[2], rows[3], 1, 5, 3, 7);
    rows[0] = __builtin_shufflevector(low01, low23, 0, 1, 4, 5);
    rows[1] = __builtin_shufflevector(high01, high23, 0, 1, 4, 5);
    rows[2] = __builtin_shufflevector(low01, low23, 2, 3, 6, 7);
    rows[3] = __builtin_shufflevector(high01, high23, 2, 3, 6, 7);
}

}  // namespace cloth
