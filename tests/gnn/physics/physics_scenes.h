#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "collision/proximity/proximity.h"
#include "data/core/cloth_state.h"
#include "data/core/garment.h"

/// Small scenes and the finite-difference oracle shared by the tests of gnn/physics.
namespace cloth::test {

/// A horizontal square sheet (normal +y) of n x n vertices; `irregular` moves the inner vertices in
/// the plane by that fraction of the spacing.
inline TriMesh sheet(int n, double side, double irregular = 0.2, unsigned seed = 1) {
    TriMesh mesh;
    mesh.vertices.resize(n * n, 3);
    mesh.faces.resize(2 * (n - 1) * (n - 1), 3);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> noise(-irregular, irregular);
    const double spacing = side / (n - 1);
    for (int row = 0; row < n; ++row)
        for (int column = 0; column < n; ++column) {
            const bool inner = row > 0 && column > 0 && row < n - 1 && column < n - 1;
            const double dx = inner ? noise(random) : 0.0, dz = inner ? noise(random) : 0.0;
            mesh.vertices.row(row * n + column) << (column + dx) * spacing, 0.0,
                (row + dz) * spacing;
        }
    int face = 0;
    for (int row = 0; row + 1 < n; ++row)
        for (int column = 0; column + 1 < n; ++column) {
            const int a = row * n + column, b = a + n;
            mesh.faces.row(face++) << a, b, a + 1;
            mesh.faces.row(face++) << a + 1, b, b + 1;
        }
    return mesh;
}

inline Points noise(Eigen::Index rows, double size, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0.0, size);
    Points points(rows, 3);
    for (Eigen::Index k = 0; k < points.size(); ++k) points.data()[k] = normal(random);
    return points;
}

/// A pose far from rest: stretched, bent, noisy.
inline Points deformed(const Garment& garment, unsigned seed) {
    Points x = garment.rest().vertices;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const double u = x(i, 0), w = x(i, 2);
        x.row(i) << 1.1 * u, 0.3 * std::sin(5.0 * u) + 0.2 * u * w,
            0.9 * w + 0.1 * std::cos(4.0 * u);
    }
    return x + noise(x.rows(), 0.15 * garment.mean_edge_length(), seed);
}

/// Contacts of every vertex with one plane through `point` that has moved by `motion` since t.
inline SurfaceContacts plane_contacts(const Points& x, const Vec3& point, const Vec3& normal,
                                      const Vec3& motion = Vec3::Zero()) {
    SurfaceContacts contacts;
    const Eigen::Index count = x.rows();
    contacts.obstacle.assign(static_cast<size_t>(count), 0);
    contacts.face.assign(static_cast<size_t>(count), -1);
    contacts.barycentric.setZero(count, 3);
    contacts.distance = (x.rowwise() - point.transpose()) * normal;
    contacts.point0 = x - contacts.distance * normal.transpose();
    contacts.point1 = contacts.point0.rowwise() + motion.transpose();
    contacts.normal0 = normal.transpose().replicate(count, 1);
    contacts.normal1 = contacts.normal0;
    return contacts;
}

/// Names the two fabrics in parametrised tests.
inline std::string fabric_name(const ::testing::TestParamInfo<Fabric>& parameter) {
    return parameter.param.mu < 1000.0 ? "SoftCotton" : "RealCotton";
}

using Energy = std::function<double(const Points&)>;
using Gradient = std::function<void(const Points&, Points&)>;

/// Central differences of fourth order of `energy` along every coordinate.
inline Points numeric_gradient(const Energy& energy, const Points& x, double h) {
    Points gradient(x.rows(), 3), y = x;
    for (Eigen::Index k = 0; k < x.size(); ++k) {
        auto at = [&](double offset) {
            y.data()[k] = x.data()[k] + offset;
            const double value = energy(y);
            y.data()[k] = x.data()[k];
            return value;
        };
        gradient.data()[k] = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
    }
    return gradient;
}

/// Derivative of a gradient along `direction`, by central differences of fourth order.
inline Points numeric_hessian_product(const Gradient& gradient, const Points& x,
                                      const Points& direction, double h) {
    Points plus, minus, plus2, minus2;
    gradient(x + h * direction, plus);
    gradient(x - h * direction, minus);
    gradient(x + 2.0 * h * direction, plus2);
    gradient(x - 2.0 * h * direction, minus2);
    return (8.0 * (plus - minus) - (plus2 - minus2)) / (12.0 * h);
}

/// |a - b| <= tolerance |b|, over all coordinates.
inline void expect_close(const Points& a, const Points& b, double tolerance) {
    ASSERT_EQ(a.rows(), b.rows());
    ASSERT_TRUE(a.allFinite());
    EXPECT_LE((a - b).norm(), tolerance * b.norm()) << "of norm " << b.norm();
}

/// The gradient of an energy equals finite differences of its value at `x`.
inline void expect_gradient(const Energy& energy, const Gradient& gradient, const Points& x,
                            double tolerance, double h = 1e-5) {
    Points analytic;
    gradient(x, analytic);
    expect_close(analytic, numeric_gradient(energy, x, h), tolerance);
}

}  // namespace cloth::test
