#include "gnn/physics/energy/self_contact.h"

#include "data/authoring/sheet.h"
#include "data/core/garment_pieces.h"
#include "gnn/physics/energy/incremental_potential.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::self_contact_test {

using namespace cloth::test;

namespace {

constexpr double thickness = 4e-3, dt = 1.0 / 30.0;

SelfContactSettings contact_settings() {
    SelfContactSettings settings;
    settings.thickness = thickness;
    return settings;
}

Boundary no_outside() {
    Boundary boundary;
    boundary.pin_targets.resize(0, 3);
    return boundary;
}

/// Two square sheets, the second `gap` (m) above the first.
MergedGarments layers(double gap, int vertices, unsigned seed = 2) {
    TriMesh above = make_sheet(0.3, 0.3, vertices, seed);
    above.vertices.col(1).array() += gap;
    return merge_garments("layers",
                          {Garment("below", make_sheet(0.3, 0.3, vertices), Fabric::soft_cotton()),
                           Garment("above", above, Fabric::soft_cotton())});
}

class SelfContactTest : public ::testing::Test {
 protected:
    MergedGarments sheets = layers(3e-3, 60);
    Garment garment = sheets.garment.with_pins({5, 70});
    ClothState state = ClothState::at_rest(garment);
    SelfContactEnergy energy{garment, contact_settings()};
    /// Some pairs apart, some deep, some on the wrong side.
    Points x = state.x + noise(state.x.rows(), 2e-3, 4);

    void SetUp() override { energy.begin_step(state, dt); }
    void gradient(const Points& y, Points& out) const {
        out.setZero(y.rows(), 3);
        energy.add_gradient(y, out);
    }
};

}  // namespace

TEST_F(SelfContactTest, GradientEqualsFiniteDifferences) {
    ASSERT_GT(energy.pairs().size(), 100u);
    expect_gradient([&](const Points& y) { return energy.value(y); },
                    [&](const Points& y, Points& g) { gradient(y, g); }, x, 1e-7, 1e-6);
}

TEST_F(SelfContactTest, HessianEqualsFiniteDifferencesAndIsPositive) {
    const Garment free = sheets.garment;
    SelfContactEnergy unpinned(free, contact_settings());
    unpinned.begin_step(state, dt);
    Eigen::SparseMatrix<double> hessian(3 * x.rows(), 3 * x.rows());
    unpinned.add_hessian(x, hessian);
    const Points direction = noise(x.rows(), 1.0, 9);
    Points product(x.rows(), 3);
    Eigen::Map<VectorX>(product.data(), product.size()) =
        hessian * Eigen::Map<const VectorX>(direction.data(), direction.size());
    const Points numeric = numeric_hessian_product(
        [&](const Points& y, Points& g) { gradient(y, g); }, x, direction, 1e-7);
    expect_close(product, numeric, 1e-6);
    EXPECT_GT(product.cwiseProduct(direction).sum(), 0.0);
}

TEST_F(SelfContactTest, PotentialMasksPinsAndAddsAllOfIt) {
    PotentialSettings settings;
    settings.self_contact = contact_settings();
    IncrementalPotential with(garment, settings), without(garment);
    Boundary boundary = no_outside();
    boundary.pin_targets = Points::Zero(2, 3);
    with.begin_step(state, boundary, {}, dt);
    without.begin_step(state, boundary, {}, dt);
    EXPECT_EQ(with.terms(x).self_contact, with.self_contact().value(x));
    EXPECT_EQ(with.terms(x).friction, with.layer_friction().value(x));
    EXPECT_GT(with.terms(x).friction, 0.0);
    EXPECT_NEAR(with.value(x) - without.value(x), energy.value(x) + with.terms(x).friction,
                1e-9 * with.value(x));
    Points g;
    with.value_gradient(x, g);
    for (const int pin : garment.pins()) EXPECT_EQ(g.row(pin).norm(), 0.0);

    Eigen::SparseMatrix<double> hessian;
    with.hessian(x, hessian);
    for (const int pin : garment.pins())
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(hessian.col(3 * pin + axis).nonZeros(), 3);
            EXPECT_EQ(hessian.coeff(3 * pin + axis, 3 * pin + axis), 1.0);
        }
    const Eigen::Index pattern = hessian.nonZeros();
    with.hessian(state.x, hessian);
    EXPECT_EQ(hessian.nonZeros(), pattern) << "one sparsity for all x of a step";
}

TEST_F(SelfContactTest, LayersRubOnEachOtherWithoutGravityToo) {
    PotentialSettings settings;
    settings.self_contact = contact_settings();
    IncrementalPotential potential(garment, settings);
    Boundary boundary = no_outside();
    boundary.pin_targets = Points::Zero(2, 3);
    const auto friction_under = [&](double gravity) {
        boundary.gravity = Vec3(0, -gravity, 0);
        potential.begin_step(state, boundary, {}, dt);
        return potential.terms(x).friction;
    };
    const double on_earth = friction_under(9.81);
    EXPECT_GT(on_earth, 0.0);
    EXPECT_NEAR(friction_under(0.0), on_earth, 1e-3 * on_earth);
}

TEST_F(SelfContactTest, ForcesAddUpToNothing) {
    Points g;
    gradient(x, g);
    EXPECT_GT(g.norm(), 0.1);
    EXPECT_LT(g.colwise().sum().norm(), 1e-12 * g.norm());
}

TEST_F(SelfContactTest, ALayerThatIsThroughIsDrivenBack) {
    Points through = state.x;
    through.bottomRows(through.rows() - sheets.first_vertex[1]).col(1).array() -= 0.02;
    Points g;
    gradient(through, g);
    const double up = -g.bottomRows(through.rows() - sheets.first_vertex[1]).col(1).sum();
    EXPECT_GT(up, 0.0);
    energy.separate(through);
    for (int sweep = 0; sweep < 200; ++sweep) energy.separate(through);
    for (const SelfContactEnergy::Pair& pair : energy.pairs())
        EXPECT_GT(pair.distance(through), 2.5e-3);
}

TEST_F(SelfContactTest, VerticesThatNothingRepelsMakeNoPairs) {
    const size_t all = energy.pairs().size();
    std::vector<char> unrepelled(size_t(state.x.rows()), 0);
    for (size_t i = 0; i < unrepelled.size(); i += 10) unrepelled[i] = 1;
    energy.begin_step(state, dt, unrepelled);
    EXPECT_LT(energy.pairs().size(), all);
    EXPECT_GT(energy.pairs().size(), all / 3);
    for (const SelfContactEnergy::Pair& pair : energy.pairs())
        for (const int i : pair.vertex) EXPECT_EQ(unrepelled[size_t(i)], 0);
    energy.begin_step(state, dt);
    EXPECT_EQ(energy.pairs().size(), all);
}

TEST(SelfContact, ForceDoesNotDependOnTheMesh) {
    std::vector<double> forces;
    for (const int vertices : {150, 600}) {
        const MergedGarments sheets = layers(3e-3, vertices);
        SelfContactSettings settings = contact_settings();
        settings.weight = 1e5 * 600.0 / vertices;  // it is per vertex
        SelfContactEnergy energy(sheets.garment, settings);
        const ClothState state = ClothState::at_rest(sheets.garment);
        energy.begin_step(state, dt);
        Points g = Points::Zero(state.x.rows(), 3);
        energy.add_gradient(state.x, g);
        forces.push_back(-g.bottomRows(g.rows() - sheets.first_vertex[1]).col(1).sum());
    }
    EXPECT_GT(forces[1], 0.0);
    EXPECT_NEAR(forces[0] / forces[1], 1.0, 0.2);  // the borders differ
}

TEST(SelfContact, OffMeansNothingIsBuiltAndTheSameBits) {
    const Garment garment("sheet", sheet(9, 0.3), Fabric::soft_cotton());
    SelfContactEnergy off(garment, {});
    EXPECT_FALSE(off.on());
    ClothState state = ClothState::at_rest(garment);
    off.begin_step(state, dt);
    EXPECT_TRUE(off.pairs().empty());
    EXPECT_EQ(off.value(state.x), 0.0);
}

TEST(SelfContact, RefusesSettingsOutOfRange) {
    const Garment garment("sheet", sheet(4, 0.3), Fabric::soft_cotton());
    PotentialSettings settings;
    settings.self_contact.thickness = 0.1;
    try {
        const IncrementalPotential potential(garment, settings);
        FAIL() << "took a thickness of 10 cm";
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("SelfContactSettings.thickness"),
                  std::string::npos);
        EXPECT_NE(std::string(error.what()).find("use"), std::string::npos);
    }
}

}  // namespace cloth::self_contact_test
