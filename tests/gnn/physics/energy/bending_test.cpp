#include "gnn/physics/energy/bending.h"

#include <Eigen/Eigenvalues>

#include "gnn/physics/energy/angle.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::bending_test {

using namespace cloth::test;

namespace {

class BendingTest : public ::testing::TestWithParam<Fabric> {
 protected:
    Garment garment{"sheet", sheet(6, 0.3), GetParam()};
    BendingEnergy bending{garment};
    BlockPattern pattern{garment};

    void gradient(const Points& x, Points& out) const {
        out.setZero(x.rows(), 3);
        bending.add_gradient(x, out);
    }
    Eigen::SparseMatrix<double> hessian(const Points& x, HessianKind kind) const {
        Eigen::SparseMatrix<double> h;
        pattern.reset(h);
        bending.add_hessian(x, pattern, kind, h.valuePtr());
        return h;
    }
};

/// Two right triangles of legs 1 m, hinged along their common hypotenuse.
TriMesh folded_square() {
    TriMesh mesh;
    mesh.vertices.resize(4, 3);
    mesh.vertices << 0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0, 1;
    mesh.faces.resize(2, 3);
    mesh.faces << 0, 1, 2, 2, 1, 3;
    return mesh;
}

}  // namespace

TEST(FastAtan2, AgreesWithTheStandardLibrary) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
    for (int k = 0; k < 20000; ++k) {
        const double y = coordinate(random), x = coordinate(random) * (k % 7 ? 1.0 : 1e-9);
        EXPECT_NEAR(fast_atan2(y, x), std::atan2(y, x), 5e-16 * 4);
    }
    EXPECT_EQ(fast_atan2(0.0, 0.0), 0.0);
    EXPECT_EQ(fast_atan2(0.0, 1.0), 0.0);
    EXPECT_DOUBLE_EQ(fast_atan2(1.0, 0.0), std::acos(0.0));
    EXPECT_DOUBLE_EQ(fast_atan2(0.0, -1.0), std::acos(-1.0));
}

TEST_P(BendingTest, FoldedSquareHasTheClosedForm) {
    const Garment square("square", folded_square(), GetParam());
    const BendingEnergy energy(square);
    for (double angle : {0.3, -1.2, 3.0}) {
        // Turn the last vertex about the hinge, the line through vertices 1 and 2.
        Points x = square.rest().vertices;
        const Vec3 origin = x.row(1), axis = Vec3(x.row(2).transpose() - origin).normalized();
        const Vec3 arm = x.row(3).transpose() - origin;
        x.row(3) = (origin + Eigen::AngleAxisd(angle, axis) * arm).transpose();
        const double expected = GetParam().bending * 2.0 / (4.0 * 1.0) * angle * angle / 2.0;
        EXPECT_NEAR(energy.value(x), expected, 1e-12 * expected);
    }
}

TEST_P(BendingTest, ZeroWhenFlatAndUnderRigidMotion) {
    const Eigen::Matrix3d rotation = Eigen::AngleAxisd(0.7, Vec3(1, -2, 1).normalized()).matrix();
    const Points moved =
        (garment.rest().vertices * rotation.transpose()).rowwise() + Eigen::RowVector3d(1, 2, 3);
    EXPECT_LT(bending.value(garment.rest().vertices), 1e-25 * GetParam().bending);
    EXPECT_LT(bending.value(moved), 1e-22 * GetParam().bending);
    const Points x = deformed(garment, 4);
    const Points x_moved = (x * rotation.transpose()).rowwise() + Eigen::RowVector3d(1, 2, 3);
    EXPECT_NEAR(bending.value(x_moved), bending.value(x), 1e-11 * bending.value(x));
}

TEST_P(BendingTest, ZeroAtTheRestAnglesOfACurvedGarment) {
    TriMesh curved = garment.rest();
    for (Eigen::Index i = 0; i < curved.vertices.rows(); ++i)
        curved.vertices(i, 1) = 0.05 * std::sin(9.0 * curved.vertices(i, 0));
    const Garment flat("flat", curved, GetParam(), {}, false);
    const Garment kept("kept", curved, GetParam(), {}, true);
    EXPECT_GT(BendingEnergy(flat).value(curved.vertices), 1e-2 * GetParam().bending);
    EXPECT_LT(BendingEnergy(kept).value(curved.vertices), 1e-25 * GetParam().bending);
}

TEST_P(BendingTest, GradientEqualsFiniteDifferences) {
    for (unsigned seed : {1u, 2u, 3u})
        expect_gradient([&](const Points& x) { return bending.value(x); },
                        [&](const Points& x, Points& g) { gradient(x, g); },
                        deformed(garment, seed), 1e-7, 2e-6);
}

TEST_P(BendingTest, GradientEqualsFiniteDifferencesWithRestAngles) {
    TriMesh curved = garment.rest();
    curved.vertices = deformed(garment, 8);
    const Garment kept("kept", curved, GetParam(), {}, true);
    const BendingEnergy energy(kept);
    const auto gradient_of = [&](const Points& x, Points& g) {
        g.setZero(x.rows(), 3);
        energy.add_gradient(x, g);
    };
    expect_gradient([&](const Points& x) { return energy.value(x); }, gradient_of,
                    curved.vertices + noise(curved.vertices.rows(), 0.005, 3), 1e-7, 2e-6);
}

TEST_P(BendingTest, ForcesNeitherPushNorTurnTheWhole) {
    const Points x = deformed(garment, 5);
    Points g;
    gradient(x, g);
    Vec3 torque = Vec3::Zero();
    for (Eigen::Index i = 0; i < x.rows(); ++i) torque += Vec3(x.row(i)).cross(Vec3(g.row(i)));
    EXPECT_LT(g.colwise().sum().norm(), 1e-12 * g.norm() * x.rows());
    EXPECT_LT(torque.norm(), 1e-12 * g.norm() * x.rows());
}

TEST_P(BendingTest, ExactHessianEqualsFiniteDifferences) {
    for (unsigned seed : {1u, 2u}) {
        const Points x = deformed(garment, seed), direction = noise(x.rows(), 1.0, seed + 10);
        const Points numeric = numeric_hessian_product(
            [&](const Points& y, Points& g) { gradient(y, g); }, x, direction, 2e-6);
        Points product(x.rows(), 3);
        Eigen::Map<VectorX>(product.data(), product.size()) =
            hessian(x, HessianKind::exact) *
            Eigen::Map<const VectorX>(direction.data(), direction.size());
        expect_close(product, numeric, 1e-7);
    }
}

TEST_P(BendingTest, ExactHessianIsSymmetric) {
    const Eigen::MatrixXd h = hessian(deformed(garment, 3), HessianKind::exact);
    EXPECT_LT((h - h.transpose()).norm(), 1e-12 * h.norm());
}

TEST_P(BendingTest, ProjectedHessianIsPositiveSemiDefiniteAndExactWhenFlat) {
    const Eigen::MatrixXd bent = hessian(deformed(garment, 3), HessianKind::projected);
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(bent, Eigen::EigenvaluesOnly);
    EXPECT_GT(solver.eigenvalues().minCoeff(), -1e-12 * solver.eigenvalues().maxCoeff());
    const Points flat = garment.rest().vertices;
    const Eigen::MatrixXd exact = hessian(flat, HessianKind::exact);
    const Eigen::MatrixXd projected = hessian(flat, HessianKind::projected);
    EXPECT_LT((exact - projected).norm(), 1e-12 * exact.norm());
}

TEST_P(BendingTest, CollapsedFacesStayFinite) {
    for (const Vec3& scale : {Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(1e-12, 0, 1)}) {
        const Points collapsed = deformed(garment, 2) * scale.asDiagonal();
        Points g;
        gradient(collapsed, g);
        EXPECT_TRUE(g.allFinite());
        EXPECT_TRUE(std::isfinite(bending.value(collapsed)));
        const auto h = hessian(collapsed, HessianKind::projected);
        for (Eigen::Index k = 0; k < h.nonZeros(); ++k) ASSERT_TRUE(std::isfinite(h.valuePtr()[k]));
    }
}

INSTANTIATE_TEST_SUITE_P(Fabrics, BendingTest,
                         ::testing::Values(Fabric::soft_cotton(), Fabric::real_cotton()),
                         fabric_name);

}  // namespace cloth::bending_test
