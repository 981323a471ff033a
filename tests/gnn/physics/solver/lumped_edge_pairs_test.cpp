#include "gnn/physics/solver/lumped_edge_pairs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>

#include "data/authoring/sheet.h"
#include "data/core/garment_pieces.h"
#include "gnn/physics/energy/incremental_potential.h"
#include "gnn/physics/solver/contact_hessian.h"
#include "gnn/physics/solver/quasi_newton.h"
#include "gnn/physics/solver/quasi_newton_matrix.h"
#include "tests/gnn/physics/stepper/self_contact_scenes.h"

namespace cloth {
namespace {

constexpr double dt = 1.0 / 30.0, thickness = 4e-3, distance = 3e-3;

PotentialSettings with_layers(double layer_thickness, double friction) {
    PotentialSettings settings;
    settings.self_contact.thickness = layer_thickness;
    settings.self_contact.friction = friction;
    return settings;
}

/// Two flat sheets of different meshes, one above the other.
struct Layers {
    Layers() {
        TriMesh above = make_sheet(0.3, 0.3, 500, 2);
        above.vertices.col(1).array() += distance;
        garment = merge_garments(
                      "layers", {Garment("below", make_sheet(0.3, 0.3, 500), Fabric::soft_cotton()),
                                 Garment("above", above, Fabric::soft_cotton())})
                      .garment;
        state = ClothState::at_rest(garment);
    }
    Garment garment = Garment("none", make_sheet(0.1, 0.1, 9), Fabric::soft_cotton());
    ClothState state;
};

SelfContactEnergy energy_of(const Garment& garment, const ClothState& state) {
    SelfContactEnergy energy(garment, with_layers(thickness, 0.0).self_contact);
    energy.begin_step(state, dt);
    return energy;
}

void expect_corners_to_have_pairs_that_point_alike(const SelfContactEnergy& energy,
                                                   const LumpedEdgePairs& edge_pairs) {
    const auto& pairs = energy.pairs();
    std::set<size_t> seen;
    for (const LumpedEdgePairs::Lumped& lumped : edge_pairs.lumped()) {
        ASSERT_LT(lumped.pair, pairs.size());
        ASSERT_GE(lumped.pair, energy.vertex_pairs());
        EXPECT_TRUE(seen.insert(lumped.pair).second);
        EXPECT_NEAR(std::accumulate(lumped.share.begin(), lumped.share.end(), 0.0), 1.0, 1e-12);
        const SelfContactEnergy::Pair& edges = pairs[lumped.pair];
        for (size_t k = 0; k < 4; ++k) {
            ASSERT_LT(lumped.to[k], energy.vertex_pairs());
            const SelfContactEnergy::Pair& pair = pairs[lumped.to[k]];
            EXPECT_EQ(pair.vertex[0], edges.vertex[k]);
            EXPECT_EQ(pair.weight[0], 1.0);
            EXPECT_GT(pair.normal.dot(k < 2 ? edges.normal : Vec3(-edges.normal)), 0.79);
        }
    }
}

TEST(LumpedEdgePairs, CornersHavePairsOfTheirOwnThatPointAlike) {
    const Layers flat;
    test::LayerScene folded = test::folded_sheet(900);
    for (auto [garment, state] :
         {std::pair(&flat.garment, &flat.state),
          std::pair<const Garment*, const ClothState*>(&folded.garment, &folded.start)}) {
        SelfContactEnergy energy(*garment, with_layers(0.014, 0.0).self_contact);
        energy.begin_step(*state, dt);
        LumpedEdgePairs edge_pairs;
        edge_pairs.begin_step(energy, static_cast<size_t>(garment->vertex_count()));
        const size_t edges = energy.pairs().size() - energy.vertex_pairs();
        ASSERT_GT(energy.vertex_pairs(), 100u);
        EXPECT_GT(edge_pairs.lumped().size(), edges / 2);
        expect_corners_to_have_pairs_that_point_alike(energy, edge_pairs);
    }
}

TEST(LumpedEdgePairs, EdgesWhoseCornersMeetNoFaceStayPairs) {
    // Two ribbons of one rectangle each cross in the middle, far from their corners.
    const auto ribbon = [](const char* name, double width, double depth, double height) {
        TriMesh mesh;
        mesh.vertices.resize(4, 3);
        mesh.vertices << 0, height, 0, width, height, 0, width, height, depth, 0, height, depth;
        mesh.vertices.col(0).array() -= 0.5 * width;
        mesh.vertices.col(2).array() -= 0.5 * depth;
        mesh.faces.resize(2, 3);
        mesh.faces << 0, 2, 1, 0, 3, 2;
        return Garment(name, mesh, Fabric::soft_cotton());
    };
    const Garment crossed = merge_garments("crossed", {ribbon("one", 0.2, 0.02, 0.0),
                                                       ribbon("other", 0.02, 0.2, distance)})
                                .garment;
    const SelfContactEnergy energy = energy_of(crossed, ClothState::at_rest(crossed));
    ASSERT_GT(energy.pairs().size(), 0u);
    LumpedEdgePairs edge_pairs;
    edge_pairs.begin_step(energy, static_cast<size_t>(crossed.vertex_count()));
    EXPECT_TRUE(edge_pairs.lumped().empty());
}

TEST(LumpedEdgePairs, AreThoseOfTheLastStep) {
    const Layers layers;
    const auto vertices = static_cast<size_t>(layers.garment.vertex_count());
    LumpedEdgePairs edge_pairs;
    edge_pairs.begin_step(energy_of(layers.garment, layers.state), vertices);
    EXPECT_FALSE(edge_pairs.lumped().empty());
    ClothState apart = layers.state;
    for (Eigen::Index i = 0; i < apart.x.rows(); ++i) apart.x(i, 1) *= 100.0;
    edge_pairs.begin_step(energy_of(layers.garment, apart), vertices);
    EXPECT_TRUE(edge_pairs.lumped().empty());
}

/// Flat layers that move apart, or slide, as a whole feel what the energy says.
TEST(ContactHessian, HoldsLayersAsAWholeAsTheirPairsDo) {
    const Layers layers;
    IncrementalPotential with(layers.garment, with_layers(thickness, 0.5)),
        without(layers.garment, with_layers(0.0, 0.0));
    SurfaceContacts none;
    Boundary boundary;
    boundary.pin_targets.resize(0, 3);
    Proximity().query(layers.state.x, boundary, none);
    with.begin_step(layers.state, boundary, none, dt);
    without.begin_step(layers.state, boundary, none, dt);
    ASSERT_FALSE(with.layer_friction().sliders().empty());

    QuasiNewtonMatrix matrix(layers.garment);
    ASSERT_TRUE(matrix.prepare(layers.garment, dt));
    ContactHessian contacts;
    contacts.begin_step(with, matrix.row_of());
    contacts.linearise(with, layers.state.x);
    ASSERT_TRUE(contacts.anticipate(Points::Zero(matrix.free_count(), 3)));

    const std::vector<int> piece = garment_pieces(layers.garment);
    Eigen::SparseMatrix<double> hessian, plain;
    with.hessian(layers.state.x, hessian);
    without.hessian(layers.state.x, plain);
    for (const Vec3& motion : {Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(1, -2, 3)}) {
        Points direction = Points::Zero(layers.state.x.rows(), 3);
        for (Eigen::Index i = 0; i < direction.rows(); ++i)
            if (piece[static_cast<size_t>(i)] == 1) direction.row(i) = motion.transpose();
        const Eigen::Map<const VectorX> all(direction.data(), direction.size());
        const double expected = all.dot((hessian - plain) * all);
        ASSERT_GT(expected, 0.0);
        Points free, product = Points::Zero(matrix.free_count(), 3);
        matrix.gather(direction, free);
        contacts.add_product(free, product);
        EXPECT_NEAR(product.cwiseProduct(free).sum() / expected, 1.0, 1e-9);
    }
    size_t couplings = 0;
    contacts.for_each_coupling([&](const ContactHessian::Coupling&) { ++couplings; });
    EXPECT_LT(couplings, with.self_contact().pairs().size() / 2);
}

/// The energy that one direction gains when layers are pressed into each other.
double gain_of_a_step(const Layers& layers, ContactHessian::EdgePairs edge_pairs) {
    IncrementalPotential potential(layers.garment, with_layers(thickness, 0.5));
    SurfaceContacts none;
    Boundary boundary;
    boundary.pin_targets.resize(0, 3);
    Proximity().query(layers.state.x, boundary, none);
    potential.begin_step(layers.state, boundary, none, dt);
    Points x = layers.state.x, gradient, right_side, step;
    const std::vector<int> piece = garment_pieces(layers.garment);
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        if (piece[static_cast<size_t>(i)] == 1) x(i, 1) -= 1e-3 * (1.0 + std::sin(40.0 * x(i, 0)));
    const double before = potential.value_gradient(x, gradient);

    QuasiNewtonMatrix matrix(layers.garment);
    EXPECT_TRUE(matrix.prepare(layers.garment, dt));
    ContactHessian contacts(edge_pairs);
    contacts.begin_step(potential, matrix.row_of());
    contacts.linearise(potential, x);
    matrix.gather(Points(-gradient), right_side);
    matrix.solve(right_side, contacts, QuasiNewtonSettings().contact_cg_iterations, step);
    matrix.add_scaled(1.0, step, x);
    return before - potential.value(x);
}

TEST(ContactHessian, LumpedPairsGuideAsWellAsSingleOnes) {
    const Layers layers;
    const double single = gain_of_a_step(layers, ContactHessian::EdgePairs::single);
    ASSERT_GT(single, 0.0);
    EXPECT_GT(gain_of_a_step(layers, ContactHessian::EdgePairs::lumped), 0.95 * single);
}

}  // namespace
}  // namespace cloth
