#include "gnn/graph/features.h"

#include <algorithm>
#include <cmath>

#include "data/core/check_range.h"

namespace cloth {

namespace {

constexpr int enough_rows = 2000;  // to be worth waking threads for

/// Grows like u for small and like sqrt(u) for large arguments: contact and stiff cloth give forces
/// over many decades.
Vec3 squash(const Vec3& u) {
    return u / std::sqrt(1.0 + u.norm());
}

/// Keeps a broken state from putting infinities into the network; 1e4 is far outside any real step.
float bounded(double value) {
    return std::isfinite(value) ? static_cast<float>(std::clamp(value, -1e4, 1e4)) : 0.0f;
}

template <auto feature>
void put(MatrixF& features, Eigen::Index row, const Vec3& value) {
    for (int k = 0; k < 3; ++k) features(row, first_column<feature> + k) = bounded(value[k]);
}

template <auto feature>
void put(MatrixF& features, Eigen::Index row, double value) {
    features(row, first_column<feature>) = bounded(value);
}

double log_fraction(double value, double low, double high) {
    return std::log(std::max(value, 1e-12) / low) / std::log(high / low);
}

/// HOOD's training ranges times its thickness of 0.47 mm.
Vec3 scaled_material(const Fabric& fabric) {
    return {log_fraction(fabric.bending, 6.37e-8, 1.314e-3), log_fraction(fabric.mu, 7.48, 29.9),
            (fabric.lambda - 1.66) / (43.9 - 1.66)};
}

}  // namespace

FeatureBuilder::FeatureBuilder(const Garment& garment, const ClothGraph& graph,
                               FeatureSettings settings)
    : m_garment(&garment),
      m_graph(&graph),
      m_settings(settings),
      m_material(scaled_material(garment.fabric())) {
    check_range("FeatureSettings.world_radius", settings.world_radius, 1e-3, 1.0);
    const auto log = [](double value) { return bounded(std::log(value)); };
    m_log_mass = garment.masses().unaryExpr(log);
    m_log_rest_length = graph.rest_length.unaryExpr(log);
}

bool FeatureBuilder::build(const ClothState& state, const Boundary& boundary,
                           const IncrementalPotential& potential, const Points& base,
                           Features& features, PotentialValue* at_base) {
    features.base = base;
    features.scale = output_scale(potential.dt());
    build_nodes(state, boundary, potential, features);
    if (m_settings.force_features)
        build_forces(state, potential, features, at_base ? *at_base : m_at_base);
    build_edges(state, features);
    build_world(state, boundary, potential, features);
    return m_settings.force_features;
}

void FeatureBuilder::build_nodes(const ClothState& state, const Boundary& boundary,
                                 const IncrementalPotential& potential, Features& features) {
    const double dt = potential.dt(), per_metre = 1.0 / features.scale;
    const Eigen::Index count = state.x.rows();
    features.node.resize(count, feature_count(node_layout(m_settings.force_features)));
    const bool any_contacts = !potential.contacts().obstacle.empty();
    vertex_normals(state.x, m_garment->rest().faces, m_normals);
#pragma omp parallel for if (count >= enough_rows)
    for (Eigen::Index i = 0; i < count; ++i) {
        const bool pinned = m_garment->is_pinned()[static_cast<size_t>(i)];
        const Vec3 x = state.x.row(i), base = features.base.row(i);
        const Vec3 velocity = dt * state.v.row(i).transpose();
        Vec3 acceleration = boundary.gravity;
        if (boundary.accelerations.rows() == count) acceleration += boundary.accelerations.row(i);
        // A pinned vertex moves by what its target asks for, whatever it did before.
        put<NodeFeature::velocity>(features.node, i,
                                   per_metre * (pinned ? Vec3(base - x) : velocity));
        put<NodeFeature::normal>(features.node, i, Vec3(m_normals.row(i)));
        put<NodeFeature::acceleration>(features.node, i, Vec3(per_metre * dt * dt * acceleration));
        put<NodeFeature::projection>(
            features.node, i, pinned ? Vec3::Zero() : squash(per_metre * (base - x - velocity)));
        put<NodeFeature::log_mass>(features.node, i, m_log_mass[i]);
        put<NodeFeature::pinned>(features.node, i, pinned ? 1.0 : 0.0);
        put<NodeFeature::material>(features.node, i, m_material);
        const bool near = any_contacts && potential.contacts().has(i) &&
                          potential.contacts().distance[i] < m_settings.world_radius;
        put<NodeFeature::near_obstacle>(features.node, i, near ? 1.0 : 0.0);
    }
}

void FeatureBuilder::build_forces(const ClothState& state, const IncrementalPotential& potential,
                                  Features& features, PotentialValue& at_base) {
    const double dt = potential.dt(), per_metre = 1.0 / features.scale;
    const double stiffness = m_garment->fabric().longitudinal();
    const VectorX& masses = m_garment->masses();
    const auto displacement = [&](const Points& gradient, Eigen::Index i) {
        return squash(-dt * dt * per_metre / masses[i] * gradient.row(i).transpose());
    };
    const Eigen::Index count = state.x.rows();
    potential.elastic_gradient(state.x, m_elastic_now);
    at_base.energy = potential.value_gradient(features.base, at_base.gradient, &m_elastic_base);
    const Points& gradient = at_base.gradient;
#pragma omp parallel for if (count >= enough_rows)
    for (Eigen::Index i = 0; i < count; ++i) {
        put<NodeFeature::elastic_now>(features.node, i, displacement(m_elastic_now, i));
        put<NodeFeature::elastic_base>(features.node, i, displacement(m_elastic_base, i));
        put<NodeFeature::force_base>(features.node, i, displacement(gradient, i));
        // The step of one Jacobi iteration of the quasi-Newton matrix M/dt^2 + (2 mu + lambda) L.
        const double diagonal =
            masses[i] / (dt * dt) + stiffness * std::max(0.0, m_graph->laplacian_diagonal[i]);
        put<NodeFeature::jacobi_base>(features.node, i,
                                      squash(-per_metre / diagonal * gradient.row(i).transpose()));
    }
}

void FeatureBuilder::build_edges(const ClothState& state, Features& features) const {
    features.edge.resize(m_graph->edge_count(), feature_count(edge_layout()));
#pragma omp parallel for if (m_graph->edge_count() >= enough_rows)
    for (int e = 0; e < m_graph->edge_count(); ++e) {
        const int i = m_graph->receivers[static_cast<size_t>(e)];
        const int j = m_graph->senders[static_cast<size_t>(e)];
        const double rest = m_graph->rest_length[e];
        const Vec3 now = (state.x.row(j) - state.x.row(i)) / rest;
        const Vec3 next = (features.base.row(j) - features.base.row(i)) / rest;
        put<EdgeFeature::relative_now>(features.edge, e, now);
        put<EdgeFeature::strain_now>(features.edge, e, now.norm() - 1.0);
        put<EdgeFeature::relative_base>(features.edge, e, next);
        put<EdgeFeature::strain_base>(features.edge, e, next.norm() - 1.0);
        put<EdgeFeature::log_rest_length>(features.edge, e, m_log_rest_length[e]);
    }
}

void FeatureBuilder::build_world(const ClothState& state, const Boundary& boundary,
                                 const IncrementalPotential& potential, Features& features) const {
    const SurfaceContacts& contacts = potential.contacts();
    const double per_metre = 1.0 / features.scale, eps = potential.settings().contact_distance;
    const Eigen::Index count = state.x.rows();
    features.world.setZero(count, feature_count(world_layout()));
    features.body.setZero(count, feature_count(body_layout()));
    features.world_mask.setZero(count);
    features.any_world = false;
    if (contacts.obstacle.empty()) return;
    for (Eigen::Index i = 0; i < count; ++i) {
        if (!contacts.has(i) || contacts.distance[i] >= m_settings.world_radius) continue;
        features.any_world = true;
        features.world_mask[i] = 1.0f;
        const Vec3 now = state.x.row(i) - contacts.point0.row(i);
        const Vec3 next = features.base.row(i) - contacts.point1.row(i);
        const Vec3 velocity = contacts.point1.row(i) - contacts.point0.row(i);
        const Vec3 normal = contacts.normal1.row(i);
        const double distance = next.dot(normal);
        put<WorldFeature::relative_now>(features.world, i, per_metre * now);
        put<WorldFeature::length_now>(features.world, i, per_metre * now.norm());
        put<WorldFeature::relative_next>(features.world, i, per_metre * next);
        put<WorldFeature::length_next>(features.world, i, per_metre * next.norm());
        put<WorldFeature::body_velocity>(features.world, i, per_metre * velocity);
        put<WorldFeature::body_normal>(features.world, i, normal);
        put<WorldFeature::distance_now>(features.world, i, per_metre * contacts.distance[i]);
        put<WorldFeature::distance_next>(features.world, i, per_metre * distance);
        // Contact acts within a fraction of eps: resolved apart from the distance in
        // centimetres.
        put<WorldFeature::nearness>(features.world, i, std::tanh((distance - eps) / (0.25 * eps)));
        put<BodyFeature::velocity>(features.body, i, per_metre * velocity);
        put<BodyFeature::normal>(features.body, i, normal);
        const auto& obstacle =
            boundary.obstacles[static_cast<size_t>(contacts.obstacle[static_cast<size_t>(i)])];
        put<BodyFeature::friction>(features.body, i, obstacle.friction);
    }
}

}  // namespace cloth
