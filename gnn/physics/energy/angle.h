#pragma once

#include <cmath>

namespace cloth {

/// atan2 to 4e-16 without branches, for loops that the compiler vectorises; 0 at the origin.
/// Reduced to |t| <= tan(pi/8), then t times a polynomial in t^2 (Chebyshev interpolation of degree
/// 11 of atan(t)/t, error 1.3e-18).
inline double fast_atan2(double y, double x) {
    constexpr double pi = 3.14159265358979323846, tan_eighth = 0.41421356237309504880;
    const double ay = std::fabs(y), ax = std::fabs(x);
    const double small = ay < ax ? ay : ax;
    const double large = (ay < ax ? ax : ay) + 1e-300;
    const bool reduce = small > tan_eighth * large;
    const double t = (reduce ? small - large : small) / (reduce ? small + large : large);
    const double z = t * t;
    double p = -0.01780539570453750738;
    p = p * z + 0.03796525609957656843;
    p = p * z - 0.05035102403943029413;
    p = p * z + 0.05846878285787001096;
    p = p * z - 0.0666295181206183696;
    p = p * z + 0.07692045330765911845;
    p = p * z - 0.09090896809056437781;
    p = p * z + 0.1111111074491939576;
    p = p * z - 0.1428571427925023967;
    p = p * z + 0.1999999999994089141;
    p = p * z - 0.3333333333333312116;
    p = p * z + 0.9999999999999999987;
    double angle = t * p + (reduce ? 0.25 * pi : 0.0);
    angle = ay <= ax ? angle : 0.5 * pi - angle;
    angle = x < 0.0 ? pi - angle : angle;
    return y < 0.0 ? -angle : angle;
}

/// An angle difference of less than 4 pi brought to [-pi, pi].
inline double wrap_angle(double angle) {
    constexpr double pi = 3.14159265358979323846;
    angle = angle > pi ? angle - 2.0 * pi : angle;
    return angle < -pi ? angle + 2.0 * pi : angle;
}

}  // namespace cloth
