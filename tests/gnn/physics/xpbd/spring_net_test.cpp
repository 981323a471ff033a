#include "gnn/physics/xpbd/spring_net.h"

#include "data/authoring/sheet.h"
#include "gnn/physics/energy/bending.h"
#include "gnn/physics/energy/strain.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::spring_net_test {

using namespace cloth::test;

namespace {

/// A lattice of equilateral triangles in the plane y = 0.
TriMesh lattice(int rows, int columns, double edge) {
    TriMesh mesh = sheet(2, 1.0);
    mesh.vertices.resize(rows * columns, 3);
    mesh.faces.resize(2 * (rows - 1) * (columns - 1), 3);
    int face = 0;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            const int a = r * columns + c, b = a + columns;
            mesh.vertices.row(a) << (c + 0.5 * r) * edge, 0.0, std::sqrt(0.75) * r * edge;
            if (r + 1 == rows || c + 1 == columns) continue;
            mesh.faces.row(face++) << a, b, a + 1;
            mesh.faces.row(face++) << a + 1, b, b + 1;
        }
    return mesh;
}

double spring_energy(const std::vector<Spring>& springs, const Points& x) {
    double energy = 0.0;
    for (const Spring& spring : springs) {
        const double length = (x.row(spring.a) - x.row(spring.b)).norm();
        const double extension = std::min(length - spring.rest_length, spring.max_extension);
        energy += 0.5 * spring.stiffness * extension * extension;
    }
    return energy;
}

Points stretched(const Garment& garment, double along_x, double along_z) {
    const Eigen::Array3d factor(1.0 + along_x, 1.0, 1.0 + along_z);
    return (garment.rest().vertices.array().rowwise() * factor.transpose()).matrix();
}

/// Energy over that of a membrane with the same stretch: springs, stretched by little.
double stiffness_ratio(const Garment& garment, double along_x, double along_z) {
    const Points x = stretched(garment, 1e-5 * along_x, 1e-5 * along_z);
    return spring_energy(stretch_springs(garment), x) / StrainEnergy(garment).value(x);
}

/// Stiffness (N/m) against stretch along x while the sides are free: the least energy over the
/// side contraction c, a parabola in c.
double free_stiffness(const Garment& garment) {
    const std::vector<Spring> springs = stretch_springs(garment);
    const auto energy = [&](double c) {
        return spring_energy(springs, stretched(garment, 1e-5, -1e-5 * c)) / 1e-10;
    };
    const double e0 = energy(0.0), e1 = energy(1.0), e2 = energy(2.0);
    const double second = e2 - 2.0 * e1 + e0, first = e1 - e0 - 0.5 * second;
    return 2.0 * (e0 - 0.5 * first * first / second) / garment.face_areas().sum();
}

double young(const Fabric& f) {
    return 4.0 * f.mu * (f.mu + f.lambda) / f.longitudinal();
}

class SpringNet : public ::testing::TestWithParam<Fabric> {};
INSTANTIATE_TEST_SUITE_P(Fabrics, SpringNet,
                         ::testing::Values(Fabric::soft_cotton(), Fabric::real_cotton()),
                         fabric_name);

}  // namespace

TEST_P(SpringNet, ALatticeHasSpringsOfHalfRootThreeYoung) {
    const Garment garment("lattice", lattice(4, 5, 0.02), GetParam());
    const std::vector<Spring> springs = stretch_springs(garment);
    double most = 0.0, least = 1e9;
    for (const Spring& spring : springs) {
        EXPECT_NEAR(spring.rest_length, 0.02, 1e-12);
        most = std::max(most, spring.stiffness), least = std::min(least, spring.stiffness);
    }
    EXPECT_NEAR(most, std::sqrt(0.75) * young(GetParam()), 1e-9 * most) << "two faces";
    EXPECT_NEAR(least, 0.5 * most, 1e-9 * most) << "one face, on the border";
}

TEST_P(SpringNet, StretchesLikeTheFabricWhereItsSidesAreFree) {
    const double expected = young(GetParam());
    const auto ratio = [&](const TriMesh& mesh) {
        return free_stiffness(Garment("sheet", mesh, GetParam())) / expected;
    };
    EXPECT_NEAR(ratio(lattice(6, 6, 0.02)), 1.0, 1e-4);
    EXPECT_NEAR(ratio(make_sheet(0.5, 0.5, 500)), 1.0, 0.03);
    EXPECT_NEAR(ratio(sheet(15, 0.5, 0.2)), 1.0, 0.2) << "all diagonals in one direction";
}

TEST(SpringNet, FabricWithoutStiffnessHasSpringsWithoutStiffness) {
    Fabric fabric;
    fabric.mu = 0.0;
    for (const double lambda : {20.9, 0.0}) {
        fabric.lambda = lambda;
        for (const Spring& spring : stretch_springs(Garment("sheet", lattice(4, 5, 0.02), fabric)))
            EXPECT_EQ(spring.stiffness, 0.0);
    }
}

TEST(SpringNet, IsTheMembraneItselfWhereThePoissonRatioIsAThird) {
    Fabric fabric;
    fabric.lambda = fabric.mu;
    const Garment regular("lattice", lattice(6, 6, 0.02), fabric);
    const Garment irregular("sheet", make_sheet(0.5, 0.5, 500), fabric);
    for (const auto& [x, z] : {std::pair(1.0, 0.0), {0.0, 1.0}, {1.0, 1.0}, {1.0, -1.0}}) {
        EXPECT_NEAR(stiffness_ratio(regular, x, z), 1.0, 1e-4) << x << " " << z;
        EXPECT_NEAR(stiffness_ratio(irregular, x, z), 1.0, 0.05) << x << " " << z;
    }
}

TEST(SpringNet, MissesOtherPoissonRatiosByTheStatedPart) {
    const auto check = [](const Fabric& fabric, double shear, double one_way, double both_ways) {
        const Garment garment("lattice", lattice(6, 6, 0.02), fabric);
        EXPECT_NEAR(stiffness_ratio(garment, 1.0, -1.0), 1.0 + shear, 0.005);
        EXPECT_NEAR(stiffness_ratio(garment, 1.0, 0.0), 1.0 + one_way, 0.005);
        EXPECT_NEAR(stiffness_ratio(garment, 1.0, 1.0), 1.0 + both_ways, 0.005);
    };
    check(Fabric::soft_cotton(), 0.11, -0.14, -0.23);
    check(Fabric::real_cotton(), -0.025, 0.024, 0.05);
}

namespace {

/// Two triangles that share the edge along z and are folded by `angle`.
TriMesh hinge(double angle) {
    TriMesh mesh = sheet(2, 1.0);
    mesh.vertices << 0.0, 0.0, 0.0, 0.0, 0.0, 0.02, 0.015, 0.0, 0.012, -0.01, 0.0, 0.004;
    mesh.vertices.row(3) << -0.01 * std::cos(angle), -0.01 * std::sin(angle), 0.004;
    mesh.faces << 0, 1, 2, 1, 0, 3;
    return mesh;
}

double bend_ratio(const Garment& garment, double fitted, double angle) {
    const Points x = hinge(angle).vertices;
    return spring_energy(bending_springs(garment, fitted), x) / BendingEnergy(garment).value(x);
}

}  // namespace

TEST(BendingSprings, HaveTheFabricsEnergyAtTheFittedAngle) {
    const Garment flat("hinge", hinge(0.0), Fabric::soft_cotton());
    for (const double fitted : {0.2, 0.5, 1.0}) {
        EXPECT_NEAR(bend_ratio(flat, fitted, fitted), 1.0, 1e-6);
        EXPECT_NEAR(bend_ratio(flat, fitted, -fitted), 1.0, 1e-6);
        EXPECT_NEAR(bend_ratio(flat, fitted, 0.5 * fitted), 0.25, 0.03) << "of fourth order";
    }
}

TEST(BendingSprings, RestAtTheGarmentsAngleWhereTheGarmentHasOne) {
    const Garment folded("hinge", hinge(0.6), Fabric::soft_cotton(), {}, true);
    EXPECT_NEAR(spring_energy(bending_springs(folded, 0.5), hinge(0.6).vertices), 0.0, 1e-15);
    EXPECT_NEAR(bend_ratio(folded, 0.5, 1.1), 1.0, 1e-6);
    EXPECT_GT(spring_energy(bending_springs(folded, 0.5), hinge(0.0).vertices), 0.0);
    const Garment flat("hinge", hinge(0.6), Fabric::soft_cotton());
    EXPECT_NEAR(bend_ratio(flat, 0.5, 0.5), 1.0, 1e-6) << "flat by default, as in bending.h";
}

TEST(BendingSprings, DoNotStiffenTheMembrane) {
    const Garment garment("sheet", make_sheet(0.5, 0.5, 300), Fabric::soft_cotton());
    EXPECT_EQ(spring_energy(bending_springs(garment, 0.3), stretched(garment, 0.2, 0.1)), 0.0);
}

}  // namespace cloth::spring_net_test
