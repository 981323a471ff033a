#include "gnn/physics/solver/affine_correction.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "gnn/physics/solver/quasi_newton_matrix.h"
#include "tests/gnn/physics/solver/solver_scenes.h"

namespace cloth::affine_correction_test {
namespace {

using test::noise;
using test::sheet_on_sphere;
using test::SolverScene;

constexpr double time_step = 1.0 / 30.0;

/// A wavy sheet that is pressed on a wide sphere: P and contact blocks of one linearisation.
struct Pressed {
    explicit Pressed(int n, const std::vector<int>& pins = {})
        : scene(sheet_on_sphere(n)),
          garment(scene.garment.with_pins(pins)),
          potential(garment),
          matrix(garment) {
        for (Eigen::Index i = 0; i < scene.state.x.rows(); ++i)
            scene.state.x(i, 1) += 2e-3 * std::sin(20.0 * scene.state.x(i, 0));
        Boundary boundary;
        boundary.obstacles.push_back(test::sphere(Vec3(0.26, -5.006, 0.24), 5.0));
        boundary.pin_targets = test::rows_of(scene.state.x, pins);
        SurfaceContacts near;
        Proximity().query(scene.state.x, boundary, near);
        potential.begin_step(scene.state, boundary, near, time_step);
        EXPECT_TRUE(matrix.prepare(garment, time_step));
        contacts.begin_step(potential, matrix.row_of());
        Points x = scene.state.x;
        x.col(1).array() -= 7e-3;
        contacts.linearise(potential, x);
        matrix.gather(scene.state.x, free);
    }

    Points product(const Points& u) const {
        Points product = matrix.matrix() * u;
        contacts.add_product(u, product);
        return product;
    }
    /// What affine displacements feel of a force.
    double affine_part(const Points& a) const {
        AffineFields fields;
        fields.take(free);
        return fields.moments(a).norm();
    }
    Points affine(const Eigen::Matrix3d& gradient, const Vec3& shift) const {
        return (free * gradient.transpose()).rowwise() + shift.transpose();
    }

    SolverScene scene;
    Garment garment;
    IncrementalPotential potential;
    QuasiNewtonMatrix matrix;
    ContactHessian contacts;
    Points free;
};

Eigen::Matrix3d some_gradient() {
    Eigen::Matrix3d gradient;
    gradient << 0.1, -0.3, 0.2, 0.5, 0.05, -0.1, 0.02, 0.4, -0.2;
    return gradient;
}

TEST(AffineFields, HoldEveryAffineDisplacement) {
    const Pressed pressed(8);
    AffineFields fields;
    fields.take(pressed.free);
    const Eigen::MatrixXd f = fields.columns();
    const Eigen::MatrixXd u = pressed.affine(some_gradient(), Vec3(0.3, -1.0, 2.0));
    const Eigen::MatrixXd fitted = f * f.colPivHouseholderQr().solve(u);
    EXPECT_LE((fitted - u).norm(), 1e-12 * u.norm());
    EXPECT_LE(
        (f.transpose() * f / static_cast<double>(f.rows()) - Eigen::Matrix4d::Identity()).norm(),
        1e-10);
}

TEST(AffineFields, LeaveOutTheDirectionAcrossAFlatSheetAndCopeWithOnePoint) {
    AffineFields fields;
    Points x = noise(20, 1.0, 4);
    x.col(1).setConstant(0.7);
    fields.take(x);
    int zero = 0;
    for (int k = 1; k < AffineFields::count; ++k) zero += fields.columns().col(k).isZero(0.0);
    EXPECT_EQ(zero, 1);
    fields.take(x.topRows(1));
    EXPECT_TRUE(fields.columns().rightCols<3>().isZero(0.0));
}

TEST(AffineCorrection, TheBlocksOnFieldsAreThoseOfTheirProducts) {
    Pressed pressed(10, {0, 9});
    const Points step = -1e-3 * noise(pressed.free.rows(), 1.0, 9).cwiseAbs();
    ASSERT_TRUE(pressed.contacts.anticipate(step));
    AffineFields fields;
    fields.take(pressed.free);
    AffineFields::System system = AffineFields::System::Zero();
    ContactProduct<double> contacts;
    const std::vector<unsigned char> part_of(static_cast<size_t>(pressed.free.rows()), 0);
    contacts.take(pressed.contacts, part_of, fields.columns().data());
    contacts.add_to(0, system);
    contacts.add_to(1, system);
    for (int column = 0; column < system.cols(); ++column) {
        AffineFields::Coefficients unit = AffineFields::Coefficients::Zero();
        unit(column / 3, column % 3) = 1.0;
        Points product = Points::Zero(pressed.free.rows(), 3);
        pressed.contacts.add_product(fields.columns() * unit, product);
        const AffineFields::Coefficients moments = fields.moments(product);
        const Eigen::Map<const Eigen::Matrix<double, 12, 1>> expected(moments.data());
        EXPECT_LE((system.col(column) - expected).norm(), 1e-9 * system.norm()) << column;
    }
    EXPECT_GT(system.norm(), 1.0) << "the blocks must matter in this test";
}

TEST(AffineCorrection, AnAffineAnswerIsFoundAtOnce) {
    Pressed pressed(10);
    const Points expected = pressed.affine(1e-5 * some_gradient(), Vec3(1e-5, -2e-5, 3e-5));
    const Points b = pressed.matrix.matrix() * expected;
    AffineCorrection correction;
    const Eigen::SparseMatrix<double> p = pressed.matrix.matrix();
    correction.take(pressed.free, p, 1.0, VectorX::Zero(p.rows()), 0.0);
    ASSERT_TRUE(correction.factorise(AffineFields::System::Zero()));
    const AffineFields::Coefficients c = correction.coefficients(correction.fields().moments(b));
    const Points found = correction.fields().columns() * c;
    const Points p_found = correction.p_columns() * c;
    EXPECT_LE((found - expected).norm(), 1e-8 * expected.norm());
    EXPECT_LE((p_found - p * found).norm(), 1e-10 * b.norm());
    EXPECT_NEAR(correction.energy(c), found.cwiseProduct(b).sum(), 1e-8 * correction.energy(c));
}

TEST(AffineCorrection, ResidualsHaveNoAffinePartAfterAnyNumberOfIterations) {
    Pressed pressed(12);
    const Points b = noise(pressed.free.rows(), 1e-3, 2);
    pressed.matrix.deflate(pressed.scene.state.x);
    for (const int iterations : {1, 2, 5, 9}) {
        Points x;
        pressed.matrix.solve(b, pressed.contacts, iterations, x);
        const Points residual = b - pressed.product(x);
        EXPECT_GT(residual.norm(), 1e-4 * b.norm()) << "not solved yet";
        EXPECT_LE(pressed.affine_part(residual), 1e-5 * pressed.affine_part(b))
            << iterations << ", but for single precision";
    }
}

TEST(AffineCorrection, ComesNearerToTheAnswerThanPlainConjugateGradients) {
    Pressed pressed(12);
    // weight: what a garment that falls on a body feels
    Points b = Points::Zero(pressed.free.rows(), 3);
    b.col(1).setConstant(-1e-3);
    const auto error_after = [&](int iterations, bool deflated, const Points& answer) {
        EXPECT_TRUE(pressed.matrix.prepare(pressed.garment, time_step));
        if (deflated) pressed.matrix.deflate(pressed.scene.state.x);
        Points x;
        pressed.matrix.solve(b, pressed.contacts, iterations, x);
        const Points error = x - answer;
        return std::sqrt(error.cwiseProduct(pressed.product(error)).sum());
    };
    Points answer;
    pressed.matrix.solve(b, pressed.contacts, 400, answer);
    for (const int iterations : {2, 4, 6})
        EXPECT_LT(error_after(iterations, true, answer), error_after(iterations, false, answer))
            << iterations;
}

}  // namespace
}  // namespace cloth::affine_correction_test
