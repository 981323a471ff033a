#include "gnn/physics/energy/strain.h"

#include <Eigen/Eigenvalues>

#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::strain_test {

using namespace cloth::test;

namespace {

class StrainTest : public ::testing::TestWithParam<Fabric> {
 protected:
    Garment garment{"sheet", sheet(6, 0.3), GetParam()};
    StrainEnergy strain{garment};
    BlockPattern pattern{garment};

    void gradient(const Points& x, Points& out) const {
        out.setZero(x.rows(), 3);
        strain.add_gradient(x, out);
    }
    Eigen::SparseMatrix<double> hessian(const Points& x, HessianKind kind) const {
        Eigen::SparseMatrix<double> h;
        pattern.reset(h);
        strain.add_hessian(x, pattern, kind, h.valuePtr());
        return h;
    }
};

/// E of a sheet stretched by the factor s along x: A (mu + lambda / 2) ((s^2 - 1) / 2)^2.
double uniaxial_energy(double area, const Fabric& fabric, double s) {
    const double green = 0.5 * (s * s - 1.0);
    return area * (fabric.mu + 0.5 * fabric.lambda) * green * green;
}

}  // namespace

TEST_P(StrainTest, UniaxialStretchHasTheClosedForm) {
    Points x = garment.rest().vertices;
    x.col(0) *= 1.2;
    const double expected = uniaxial_energy(0.09, GetParam(), 1.2);
    EXPECT_NEAR(strain.value(x), expected, 1e-12 * expected);
}

TEST_P(StrainTest, ZeroAtRestAndUnderRigidMotion) {
    const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).matrix();
    const Points rest = garment.rest().vertices;
    const Points moved = (rest * rotation.transpose()).rowwise() + Eigen::RowVector3d(3, -2, 1);
    const double scale = garment.fabric().longitudinal() * garment.face_areas().sum();
    EXPECT_LT(strain.value(rest), 1e-25 * scale);
    EXPECT_LT(strain.value(moved), 1e-25 * scale);
    Points g;
    gradient(moved, g);
    EXPECT_LT(g.norm(), 1e-12 * scale / garment.mean_edge_length());
}

TEST_P(StrainTest, RigidMotionOfADeformedSheetKeepsTheEnergyAndTurnsTheForces) {
    const Eigen::Matrix3d rotation = Eigen::AngleAxisd(-2.0, Vec3(3, 1, 1).normalized()).matrix();
    const Points x = deformed(garment, 4);
    const Points moved = (x * rotation.transpose()).rowwise() + Eigen::RowVector3d(0.1, 0.2, 0.3);
    EXPECT_NEAR(strain.value(moved), strain.value(x), 1e-11 * strain.value(x));
    Points g, g_moved;
    gradient(x, g);
    gradient(moved, g_moved);
    expect_close(g_moved, g * rotation.transpose(), 1e-11);
}

TEST_P(StrainTest, GradientEqualsFiniteDifferences) {
    for (unsigned seed : {1u, 2u, 3u})
        expect_gradient([&](const Points& x) { return strain.value(x); },
                        [&](const Points& x, Points& g) { gradient(x, g); },
                        deformed(garment, seed), 1e-8);
}

TEST_P(StrainTest, ForcesNeitherPushNorTurnTheWhole) {
    const Points x = deformed(garment, 5);
    Points g;
    gradient(x, g);
    Vec3 torque = Vec3::Zero();
    for (Eigen::Index i = 0; i < x.rows(); ++i) torque += Vec3(x.row(i)).cross(Vec3(g.row(i)));
    EXPECT_LT(g.colwise().sum().norm(), 1e-13 * g.norm() * x.rows());
    EXPECT_LT(torque.norm(), 1e-13 * g.norm() * x.rows());
}

TEST_P(StrainTest, ExactHessianEqualsFiniteDifferences) {
    for (unsigned seed : {1u, 2u}) {
        const Points x = deformed(garment, seed), direction = noise(x.rows(), 1.0, seed + 10);
        const Points numeric = numeric_hessian_product(
            [&](const Points& y, Points& g) { gradient(y, g); }, x, direction, 1e-5);
        Points product(x.rows(), 3);
        Eigen::Map<VectorX>(product.data(), product.size()) =
            hessian(x, HessianKind::exact) *
            Eigen::Map<const VectorX>(direction.data(), direction.size());
        expect_close(product, numeric, 1e-8);
    }
}

TEST_P(StrainTest, ProjectedHessianOfATriangleIsTheExactOneWithoutNegativeEigenvalues) {
    TriMesh triangle;
    triangle.vertices.resize(3, 3);
    triangle.vertices << 0, 0, 0, 0.02, 0, 0.003, 0.005, 0, 0.017;
    triangle.faces.resize(1, 3);
    triangle.faces << 0, 2, 1;
    const Garment one("triangle", triangle, GetParam());
    const StrainEnergy energy(one);
    const BlockPattern blocks(one);
    for (unsigned seed = 0; seed < 20; ++seed) {
        const Points x = triangle.vertices + noise(3, 0.006, seed);
        Eigen::SparseMatrix<double> exact, projected;
        blocks.reset(exact);
        blocks.reset(projected);
        energy.add_hessian(x, blocks, HessianKind::exact, exact.valuePtr());
        energy.add_hessian(x, blocks, HessianKind::projected, projected.valuePtr());
        // The clamp acts on eigenvalues with respect to F; both agree on where curvature is
        // positive, so the projected matrix is semi-definite and never below the exact one.
        const Eigen::MatrixXd difference = Eigen::MatrixXd(projected) - Eigen::MatrixXd(exact);
        const double scale = Eigen::MatrixXd(projected).norm();
        using Solver = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;
        EXPECT_GT(Solver(Eigen::MatrixXd(projected)).eigenvalues().minCoeff(), -1e-12 * scale);
        EXPECT_GT(Solver(difference).eigenvalues().minCoeff(), -1e-12 * scale);
    }
}

TEST_P(StrainTest, ProjectionChangesNothingInTension) {
    Points x = garment.rest().vertices;
    x.col(0) *= 1.1;
    x.col(2) *= 1.2;
    const Eigen::MatrixXd exact = hessian(x, HessianKind::exact);
    const Eigen::MatrixXd projected = hessian(x, HessianKind::projected);
    EXPECT_LT((exact - projected).norm(), 1e-12 * exact.norm());
}

TEST_P(StrainTest, CollapsedTrianglesStayFinite) {
    Points x = garment.rest().vertices;
    for (const Vec3& scale : {Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(1e-9, 0, 0)}) {
        const Points collapsed = x * scale.asDiagonal();
        Points g;
        gradient(collapsed, g);
        EXPECT_TRUE(g.allFinite());
        const auto h = hessian(collapsed, HessianKind::projected);
        for (Eigen::Index k = 0; k < h.nonZeros(); ++k) ASSERT_TRUE(std::isfinite(h.valuePtr()[k]));
    }
}

INSTANTIATE_TEST_SUITE_P(Fabrics, StrainTest,
                         ::testing::Values(Fabric::soft_cotton(), Fabric::real_cotton()),
                         fabric_name);

}  // namespace cloth::strain_test
