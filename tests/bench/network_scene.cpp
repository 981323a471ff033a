#include "tests/bench/network_scene.h"

#include <cmath>

#include "collision/proximity/proximity.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/mesh_io.h"
#include "gnn/physics/stepper/guess.h"

namespace cloth::test {
namespace {

Obstacle filling_sphere() {
    Obstacle sphere;
    sphere.shape = ObstacleShape::sphere;
    sphere.radius = 0.18;
    sphere.pose0.translation() = sphere.pose1.translation() = Vec3(0, 1.2, 0);
    return sphere;
}

/// Rows and widths of a perceptron with two hidden layers.
double perceptron(double rows, double inputs, double width, double outputs) {
    return 2.0 * rows * (inputs * width + width * width + width * outputs);
}

}  // namespace

Garment TshirtMotion::load_garment() {
    return Garment("tshirt", load_mesh(asset_path("garments/tshirt.obj")), Fabric::soft_cotton());
}

TshirtMotion::TshirtMotion(const Garment& garment)
    : m_stepper(garment, ClothStepperSettings::plain()), m_state(ClothState::at_rest(garment)) {
    try {
        m_body = std::make_unique<AnimatedBody>(std::make_shared<const Body>(Body::load_default()),
                                                load_motion_by_name("01_01"));
    } catch (const LoadError&) {
        m_boundary.obstacles = {filling_sphere()};
    }
    show_obstacle();
}

void TshirtMotion::show_obstacle() {
    if (m_body) m_boundary.obstacles = {m_body->obstacle(m_frame * dt, (m_frame + 1) * dt)};
}

void TshirtMotion::step() {
    m_stepper.step(m_boundary, dt, m_state);
    ++m_frame;
    show_obstacle();
}

TshirtMoment::TshirtMoment() : garment(TshirtMotion::load_garment()) {
    TshirtMotion motion(garment);
    for (int frame = 0; frame < 44; ++frame) motion.step();
    boundary = motion.boundary();
    state = motion.state();
}

NetworkInput::NetworkInput(const TshirtMoment& moment, const ModelConfig& config)
    : graph(build_cloth_graph(moment.garment, config.graph_settings())) {
    SurfaceContacts contacts;
    Proximity().query(moment.state.x, moment.boundary, contacts);
    IncrementalPotential potential(moment.garment);
    potential.begin_step(moment.state, moment.boundary, contacts, dt);
    Points base;
    starting_guess(moment.garment, moment.state, moment.boundary, contacts, dt,
                   PotentialSettings().contact_distance, base);
    FeatureBuilder(moment.garment, graph, config.features)
        .build(moment.state, moment.boundary, potential, base, features);
}

/// Rows of a level: its nodes, those of them near a body, and its edges.
struct LevelRows {
    double nodes, active, edges;
};

static LevelRows rows_of(int level, const ClothGraph& graph, const Features& features) {
    if (level == 0)
        return {double(graph.vertex_count), double(features.world_mask.sum()),
                double(graph.first_edge.back())};
    const CoarseLevel& coarse = graph.coarse[static_cast<size_t>(level) - 1];
    double active = 0.0;
    for (const int node : coarse.nodes) active += double(features.world_mask[node]);
    return {double(coarse.nodes.size()), active,
            double(coarse.first_edge.back() - coarse.first_edge.front())};
}

NetworkFlops network_flops(const ModelConfig& config, const ClothGraph& graph,
                           const Features& features) {
    const double d = config.width, active = rows_of(0, graph, features).active;
    const auto columns = [](const auto& matrix) { return static_cast<double>(matrix.cols()); };
    NetworkFlops flops;
    flops.encoder = perceptron(graph.vertex_count, columns(features.node), d, d) +
                    perceptron(graph.edge_count(), columns(features.edge), d, d) +
                    perceptron(active, columns(features.world), d, d) +
                    perceptron(active, columns(features.body), d, d);
    if (config.body_updates) flops.world = perceptron(active, columns(features.world), d, d);
    for (int k = 0; k < config.steps; ++k) {
        for (const int level : config.levels(k)) {
            const LevelRows rows = rows_of(level, graph, features);
            const double sampled = config.sampled_edges == 0
                                       ? rows.edges
                                       : std::min(rows.edges, rows.nodes * config.sampled_edges);
            flops.edges += perceptron(sampled, d, d, d);
            flops.products += 2.0 * rows.nodes * 2.0 * d * d;
        }
        const LevelRows rows = rows_of(config.levels(k).front(), graph, features);
        const double inputs = static_cast<double>(1 + config.levels(k).size());
        flops.nodes += perceptron(rows.nodes, inputs * d, d, d);
        if (!config.has_world(k)) continue;
        flops.nodes += 2.0 * rows.nodes * d * d;
        flops.world += perceptron(rows.active, 3.0 * d, d, d);
        if (config.body_updates && k + 1 < config.steps)  // the last step's never reach the output
            flops.world +=
                perceptron(rows.active, 3.0 * d, d, d) + perceptron(rows.active, 2.0 * d, d, d);
    }
    flops.decoder = perceptron(graph.vertex_count, d, d, 3.0);
    return flops;
}

}  // namespace cloth::test
