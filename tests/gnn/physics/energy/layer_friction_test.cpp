#include "gnn/physics/energy/layer_friction.h"

#include "data/authoring/sheet.h"
#include "data/core/garment_pieces.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::layer_friction_test {

using namespace cloth::test;

namespace {

constexpr double thickness = 4e-3, slip = 1e-4;

/// Two square sheets, the second 3.9 mm above the first, which is pinned at two vertices.
class LayerFrictionTest : public ::testing::Test {
 protected:
    Garment garment = [] {
        TriMesh above = make_sheet(0.3, 0.3, 60, 2);
        above.vertices.col(1).array() += 3.9e-3;
        return merge_garments("layers",
                              {Garment("below", make_sheet(0.3, 0.3, 60), Fabric::soft_cotton()),
                               Garment("above", above, Fabric::soft_cotton())})
            .garment.with_pins({5, 50});
    }();
    ClothState state = ClothState::at_rest(garment);
    LayerFriction friction;
    Points x = state.x + noise(state.x.rows(), 3.0 * slip, 4);

    SelfContactEnergy begin(double coefficient, double force_per_mass = 1e3) {
        SelfContactSettings settings;
        settings.thickness = thickness;
        settings.friction = coefficient;
        SelfContactEnergy contact(garment, settings);
        contact.begin_step(state, 1.0 / 30.0);
        friction.begin_step(contact, state.x, slip, force_per_mass);
        return contact;
    }
    void gradient(const Points& y, Points& out) const {
        out.setZero(y.rows(), 3);
        friction.add_gradient(y, out);
    }
};

TEST_F(LayerFrictionTest, GradientEqualsFiniteDifferencesAndKeepsMomentum) {
    begin(0.5);
    ASSERT_GT(friction.sliders().size(), 50u);
    expect_gradient([&](const Points& y) { return friction.value(y); },
                    [&](const Points& y, Points& g) { gradient(y, g); }, x, 1e-5, 1e-7);
    Points g;
    gradient(x, g);
    EXPECT_LT(g.colwise().sum().norm(), 1e-12 * g.norm());
}

TEST_F(LayerFrictionTest, HessianEqualsFiniteDifferencesAndLeavesPinsOut) {
    const SelfContactEnergy contact = begin(0.5);
    Eigen::SparseMatrix<double> hessian(3 * x.rows(), 3 * x.rows());
    friction.add_hessian(x, garment.is_pinned(), hessian);
    Points direction = noise(x.rows(), 1.0, 9);
    for (const int pin : garment.pins()) direction.row(pin).setZero();
    Points product(x.rows(), 3);
    Eigen::Map<VectorX>(product.data(), product.size()) =
        hessian * Eigen::Map<const VectorX>(direction.data(), direction.size());
    Points numeric = numeric_hessian_product([&](const Points& y, Points& g) { gradient(y, g); }, x,
                                             direction, 1e-8);
    for (const int pin : garment.pins()) numeric.row(pin).setZero();
    expect_close(product, numeric, 1e-5);
}

TEST_F(LayerFrictionTest, ALongSlipCostsTheContactForceTimesWay) {
    const SelfContactEnergy contact = begin(0.5);
    double pressed = 0.0;
    for (const SelfContactEnergy::Pair& pair : contact.pairs())
        pressed += 3.0 * pair.stiffness * std::pow(std::max(0.0, thickness - pair.start), 2);
    Points slid = state.x;
    slid.bottomRows(slid.rows() / 2).col(0).array() += 0.1;
    EXPECT_NEAR(friction.value(slid), 0.5 * pressed * 0.1, 0.5 * pressed * 2.0 * slip);
}

TEST_F(LayerFrictionTest, ForceIsLimitedByTheMassThatIsPressed) {
    begin(0.5, 2.0);
    Points slid = state.x;
    slid.bottomRows(slid.rows() / 2).col(0).array() += 0.1;
    // A vertex and face stand for the vertex's area, on either side, and two edges for theirs.
    EXPECT_LT(friction.value(slid), 0.5 * 2.0 * 2.0 * garment.masses().sum() * 0.1);
    EXPECT_GT(friction.value(slid), 0.0);
}

TEST_F(LayerFrictionTest, NothingActsWithoutCoefficientOrBeyondTheThickness) {
    begin(0.0);
    EXPECT_TRUE(friction.sliders().empty());
    state.x.bottomRows(state.x.rows() / 2).col(1).array() += 2e-4;
    begin(0.5);
    EXPECT_TRUE(friction.sliders().empty());
}

}  // namespace
}  // namespace cloth::layer_friction_test
