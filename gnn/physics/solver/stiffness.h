#pragma once

#include "data/core/types.h"

namespace cloth {

/// A symmetric 3 x 3 matrix (N/m).
struct Stiffness {
    double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;

    /// Adds across I + (along - across) n n'.
    void add(const Vec3& n, double along, double across) {
        const Vec3 scaled = (along - across) * n;
        xx += scaled[0] * n[0] + across;
        xy += scaled[0] * n[1];
        xz += scaled[0] * n[2];
        yy += scaled[1] * n[1] + across;
        yz += scaled[1] * n[2];
        zz += scaled[2] * n[2] + across;
    }
    void add(const Eigen::Matrix3d& symmetric) {
        xx += symmetric(0, 0);
        xy += symmetric(0, 1);
        xz += symmetric(0, 2);
        yy += symmetric(1, 1);
        yz += symmetric(1, 2);
        zz += symmetric(2, 2);
    }
    /// Subtracts v v'.
    void subtract(const Vec3& v) {
        xx -= v[0] * v[0];
        xy -= v[0] * v[1];
        xz -= v[0] * v[2];
        yy -= v[1] * v[1];
        yz -= v[1] * v[2];
        zz -= v[2] * v[2];
    }
    Vec3 operator*(const Vec3& u) const {
        return {xx * u[0] + xy * u[1] + xz * u[2], xy * u[0] + yy * u[1] + yz * u[2],
                xz * u[0] + yz * u[1] + zz * u[2]};
    }
};

}  // namespace cloth
