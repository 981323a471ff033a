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

}  // namespace cloth
