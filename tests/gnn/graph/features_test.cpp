#include "gnn/graph/features.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "data/authoring/sheet.h"
#include "gnn/physics/stepper/guess.h"

namespace cloth::features_test {
namespace {

constexpr double dt = 1.0 / 30.0;

/// A sheet, two corners pinned, moving and out of shape, above a sphere that moves.
struct Scene {
    explicit Scene(const TriMesh& mesh, std::vector<int> pins)
        : garment("sheet", mesh, Fabric::soft_cotton(), std::move(pins)),
          state(ClothState::at_rest(garment)) {
        for (Eigen::Index i = 0; i < state.x.rows(); ++i) {
            const Vec3 p = state.x.row(i);
            state.x.row(i) +=
                0.02 * Vec3(std::sin(9 * p.x()), std::cos(7 * p.z()), p.x()).transpose();
            state.v.row(i) = Vec3(0.3 * p.z(), -0.2, std::sin(5 * p.x())).transpose();
        }
        boundary.obstacles.resize(1);
        Obstacle& ball = boundary.obstacles[0];
        ball.shape = ObstacleShape::sphere;
        ball.radius = 0.1;
        ball.pose0.translation() = Vec3(0.02, -0.09, 0.01);
        ball.pose1.translation() = Vec3(0.03, -0.085, 0.01);
        boundary.pin_targets.resize(static_cast<Eigen::Index>(garment.pins().size()), 3);
        for (size_t k = 0; k < garment.pins().size(); ++k)
            boundary.pin_targets.row(static_cast<Eigen::Index>(k)) =
                state.x.row(garment.pins()[k]).array() + 0.003;
    }

    void shift(const Vec3& offset) {
        state.x.rowwise() += offset.transpose();
        boundary.pin_targets.rowwise() += offset.transpose();
        boundary.obstacles[0].pose0.pretranslate(offset);
        boundary.obstacles[0].pose1.pretranslate(offset);
    }

    Features features() const {
        const ClothGraph graph = build_cloth_graph(garment, {});
        Proximity proximity;
        SurfaceContacts contacts;
        proximity.query(state.x, boundary, contacts);
        IncrementalPotential potential(garment);
        potential.begin_step(state, boundary, contacts, dt);
        Points base;
        starting_guess(garment, state, boundary, contacts, dt, 4e-3, base);
        FeatureBuilder builder(garment, graph);
        Features out;
        builder.build(state, boundary, potential, base, out);
        return out;
    }

    Garment garment;
    ClothState state;
    Boundary boundary;
};

TriMesh mesh() {
    return make_sheet(0.3, 0.3, 80);
}

float largest_difference(const MatrixF& a, const MatrixF& b) {
    return (a - b).cwiseAbs().maxCoeff();
}

TEST(Features, HaveTheShapesOfTheirLayoutsAndAreFinite) {
    const Scene scene(mesh(), {0, 5});
    const Features f = scene.features();
    EXPECT_EQ(f.node.cols(), feature_count(node_layout(true)));
    EXPECT_EQ(f.edge.rows(), 2 * static_cast<Eigen::Index>(scene.garment.edges().size()));
    EXPECT_EQ(f.edge.cols(), feature_count(edge_layout()));
    EXPECT_EQ(f.world.cols(), feature_count(world_layout()));
    EXPECT_EQ(f.body.cols(), feature_count(body_layout()));
    EXPECT_TRUE(f.node.allFinite() && f.edge.allFinite() && f.world.allFinite());
}

TEST(Features, NamesAndTablesOfColumnsAgree) {
    const auto column_called = [](const FeatureLayout& layout, const std::string& name) {
        int first = 0;
        for (const FeatureGroup& group : layout) {
            if (group.name == name) return first;
            first += group.size;
        }
        return -1;
    };
    EXPECT_EQ(first_column<NodeFeature::velocity>, 0);
    EXPECT_EQ(first_column<NodeFeature::near_obstacle>, 17);
    EXPECT_EQ(first_column<NodeFeature::near_obstacle>,
              column_called(node_layout(false), "near_obstacle"));
    EXPECT_EQ(first_column<NodeFeature::elastic_now>, feature_count(node_layout(false)));
    EXPECT_EQ(first_column<NodeFeature::jacobi_base>,
              column_called(node_layout(true), "jacobi_base"));
    EXPECT_EQ(first_column<EdgeFeature::relative_base>,
              column_called(edge_layout(), "relative_base"));
    EXPECT_EQ(first_column<WorldFeature::body_normal>,
              column_called(world_layout(), "body_normal"));
    EXPECT_EQ(first_column<WorldFeature::nearness>, column_called(world_layout(), "nearness"));
    EXPECT_EQ(first_column<BodyFeature::friction>, column_called(body_layout(), "friction"));
}

TEST(Features, PinnedAndMassColumnsHoldWhatTheyAreCalled) {
    const Scene scene(mesh(), {0, 5});
    const Features f = scene.features();
    for (Eigen::Index i = 0; i < f.node.rows(); ++i) {
        EXPECT_EQ(f.node(i, first_column<NodeFeature::pinned>), i == 0 || i == 5 ? 1.0f : 0.0f);
        EXPECT_FLOAT_EQ(f.node(i, first_column<NodeFeature::log_mass>),
                        static_cast<float>(std::log(scene.garment.masses()[i])));
    }
}

TEST(Features, DoNotDependOnWhereTheSceneIs) {
    Scene scene(mesh(), {0, 5});
    const Features here = scene.features();
    scene.shift(Vec3(10.0, -3.0, 4.0));
    const Features there = scene.features();
    EXPECT_LT(largest_difference(here.node, there.node), 2e-3);
    EXPECT_LT(largest_difference(here.edge, there.edge), 1e-5);
    EXPECT_LT(largest_difference(here.world, there.world), 1e-4);
}

TEST(Features, FollowAPermutationOfTheVertices) {
    const TriMesh original = mesh();
    const int count = static_cast<int>(original.vertices.rows());
    TriMesh permuted = original;  // vertex i becomes vertex (7 i + 3) mod n
    ASSERT_NE(count % 7, 0);
    const auto moved = [count](int i) { return (7 * i + 3) % count; };
    for (int i = 0; i < count; ++i) permuted.vertices.row(moved(i)) = original.vertices.row(i);
    for (Eigen::Index f = 0; f < original.faces.rows(); ++f)
        for (int k = 0; k < 3; ++k) permuted.faces(f, k) = moved(original.faces(f, k));
    const Features a = Scene(original, {2}).features();
    const Features b = Scene(permuted, {moved(2)}).features();
    for (int i = 0; i < count; ++i) {
        EXPECT_LT((a.node.row(i) - b.node.row(moved(i))).cwiseAbs().maxCoeff(), 1e-3f);
        EXPECT_LT((a.world.row(i) - b.world.row(moved(i))).cwiseAbs().maxCoeff(), 1e-4f);
        EXPECT_EQ(a.world_mask[i], b.world_mask[moved(i)]);
    }
}

TEST(Features, WorldRowsExistWithinTheRadiusOnly) {
    const Scene scene(mesh(), {});
    const Features f = scene.features();
    const Vec3 centre = scene.boundary.obstacles[0].pose0.translation();
    int inside = 0;
    for (Eigen::Index i = 0; i < f.world_mask.size(); ++i) {
        const double distance = (scene.state.x.row(i).transpose() - centre).norm() - 0.1;
        EXPECT_EQ(f.world_mask[i] == 1.0f, distance < 0.03) << "vertex " << i;
        inside += f.world_mask[i] == 1.0f;
        if (f.world_mask[i] == 0.0f) {
            EXPECT_EQ(f.world.row(i).norm(), 0.0f);
        }
    }
    EXPECT_GT(inside, 5);
    EXPECT_LT(inside, f.world_mask.size());
}

TEST(Features, ForcesOfUndeformedClothVanishWithoutGravity) {
    Scene scene(mesh(), {});
    scene.state = ClothState::at_rest(scene.garment);
    scene.boundary = Boundary();
    scene.boundary.gravity.setZero();
    const Features f = scene.features();
    const Eigen::Index forces = f.node.cols() - first_column<NodeFeature::elastic_now>;
    EXPECT_LT(f.node.rightCols(forces).cwiseAbs().maxCoeff(), 1e-4f);
    EXPECT_FALSE(f.any_world);
}

TEST(FeatureStatistics, LeaveAConstantColumnAlone) {
    StatisticsAccumulator accumulator(
        {{"a", 1, FeatureKind::scalar}, {"v", 3, FeatureKind::vector}});
    MatrixF rows(4, 4);
    rows << 7, 1, 0, 0, 7, 0, 2, 0, 7, 0, 0, 3, 7, 0, 0, 0;
    accumulator.add(rows);
    const FeatureStatistics s = accumulator.statistics();
    EXPECT_FLOAT_EQ(s.mean[0], 7.0f);
    EXPECT_FLOAT_EQ(s.deviation[0], 1.0f);
    EXPECT_FLOAT_EQ(s.mean[1], 0.0f);
    EXPECT_FLOAT_EQ(s.deviation[1], std::sqrt(14.0f / 12.0f));
    EXPECT_FLOAT_EQ(s.deviation[2], s.deviation[1]);
}

TEST(FeatureStatistics, CountMaskedRowsOnlyWhereAsked) {
    StatisticsAccumulator accumulator({{"a", 1, FeatureKind::scalar}});
    MatrixF rows(3, 1);
    rows << 1, 3, 100;
    VectorF mask(3);
    mask << 1, 1, 0;
    accumulator.add(rows, &mask);
    EXPECT_FLOAT_EQ(accumulator.statistics().mean[0], 2.0f);
    EXPECT_FLOAT_EQ(accumulator.statistics().deviation[0], 1.0f);
}

}  // namespace
}  // namespace cloth::features_test
