#include "gnn/graph/features.h"

#include <algorithm>
#include <cmath>

#include "data/core/check_range.h"

namespace cloth {

namespace {

/// Grows like u for small and like sqrt(u) for large arguments: contact and stiff cloth give forces
/// over many decades.
Vec3 squash(const Vec3& u) {
    return u / std::sqrt(1.0 + u.norm());
}

/// Keeps a broken state from putting infinities into the network; 1e4 is far outside any real step.
float bounded(double value) {
    return std::isfinite(value) ? static_cast<float>(std::clamp(value, -1e4, 1e4)) : 0.0f;
}

void put(MatrixF& features, Eigen::Index row, int column, const Vec3& value) {
    for (int k = 0; k < 3; ++k) features(row, column + k) = bounded(value[k]);
}

void put(MatrixF& features, Eigen::Index row, int column, double value) {
    features(row, column) = bounded(value);
}

double log_fraction(double value, double low, double high) {
    return std::log(std::max(value, 1e-12) / low) / std::log(high / low);
}

/// HOOD's training ranges times its thickness of 0.47 mm (learned_cloth.md, materials).
Vec3 scaled_material(const Fabric& fabric) {
    return {log_fraction(fabric.bending, 6.37e-8, 1.314e-3), log_fraction(fabric.mu, 7.48, 29.9),
            (fabric.lambda - 1.66) / (43.9 - 1.66)};
}

void area_weighted_normals(const Points& x, const Faces& faces, Points& normals) {
    normals.setZero(x.rows(), 3);
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const Vec3 a = x.row(faces(f, 0)), b = x.row(faces(f, 1)), c = x.row(faces(f, 2));
        const Vec3 area = (b - a).cross(c - a);
        for (int corner = 0; corner < 3; ++corner)
            normals.row(faces(f, corner)) += area.transpose();
    }
    for (Eigen::Index i = 0; i < normals.rows(); ++i)
        normals.row(i) /= std::max(normals.row(i).norm(), 1e-20);
}

}  // namespace

FeatureBuilder::FeatureBuilder(const Garment& garment, const ClothGraph& graph,
                               FeatureSettings settings)
    : m_garment(&garment),
      m_graph(&graph),
      m_settings(settings),
      m_material(scaled_material(garment.fabric())) {
    check_range("FeatureSettings.world_radius", settings.world_radius, 1e-3, 1.0);
}

void FeatureBuilder::build(const ClothState& state, const Boundary& boundary,
                           const IncrementalPotential& potential, const Points& base,
                           Features& features) {
    features.base = base;
    features.scale = output_scale(potential.dt());
    build_nodes(state, boundary, potential, features);
    if (m_settings.force_features) build_forces(state, potential, features);
    build_edges(state, features);
    build_world(state, boundary, potential, features);
}

void FeatureBuilder::build_nodes(const ClothState& state, const Boundary& boundary,
                                 const IncrementalPotential& potential, Features& features) {
    const double dt = potential.dt(), per_metre = 1.0 / features.scale;
    const Eigen::Index count = state.x.rows();
    features.node.resize(count, feature_count(node_layout(m_settings.force_features)));
    area_weighted_normals(state.x, m_garment->rest().faces, m_normals);
    for (Eigen::Index i = 0; i < count; ++i) {
        const bool pinned = m_garment->is_pinned()[static_cast<size_t>(i)];
        const Vec3 x = state.x.row(i), base = features.base.row(i);
        const Vec3 velocity = dt * state.v.row(i).transpose();
        Vec3 acceleration = boundary.gravity;
        if (boundary.accelerations.rows() == count) acceleration += boundary.accelerations.row(i);
        // A pinned vertex moves by what its target asks for, whatever it did before.
        put(features.node, i, 0, per_metre * (pinned ? Vec3(base - x) : velocity));
        put(features.node, i, 3, Vec3(m_normals.row(i)));
        put(features.node, i, 6, Vec3(per_metre * dt * dt * acceleration));
        put(features.node, i, 9, pinned ? Vec3::Zero() : squash(per_metre * (base - x - velocity)));
        put(features.node, i, 12, std::log(m_garment->masses()[i]));
        put(features.node, i, 13, pinned ? 1.0 : 0.0);
        put(features.node, i, 14, m_material);
        const bool near = potential.contacts().has(i) &&
                          potential.contacts().distance[i] < m_settings.world_radius;
        put(features.node, i, 17, near ? 1.0 : 0.0);
    }
}

void FeatureBuilder::build_forces(const ClothState& state, const IncrementalPotential& potential,
                                  Features& features) {
    const double dt = potential.dt(), per_metre = 1.0 / features.scale;
    const double stiffness = m_garment->fabric().longitudinal();
    const VectorX& masses = m_garment->masses();
    const auto put_displacements = [&](int column) {
        for (Eigen::Index i = 0; i < m_gradient.rows(); ++i)
            put(features.node, i, column,
                squash(-dt * dt * per_metre / masses[i] * m_gradient.row(i).transpose()));
    };
    potential.elastic_gradient(state.x, m_gradient);
    put_displacements(18);
    potential.elastic_gradient(features.base, m_gradient);
    put_displacements(21);
    potential.value_gradient(features.base, m_gradient);
    put_displacements(24);
    // The step of one Jacobi iteration of the quasi-Newton matrix M/dt^2 + (2 mu + lambda) L.
    for (Eigen::Index i = 0; i < m_gradient.rows(); ++i) {
        const double diagonal =
            masses[i] / (dt * dt) + stiffness * std::max(0.0, m_graph->laplacian_diagonal[i]);
        put(features.node, i, 27, squash(-per_metre / diagonal * m_gradient.row(i).transpose()));
    }
}

void FeatureBuilder::build_edges(const ClothState& state, Features& features) const {
    features.edge.resize(m_graph->edge_count(), feature_count(edge_layout()));
    for (int e = 0; e < m_graph->edge_count(); ++e) {
        const int i = m_graph->receivers[static_cast<size_t>(e)];
        const int j = m_graph->senders[static_cast<size_t>(e)];
        const double rest = m_graph->rest_length[e];
        const Vec3 now = (state.x.row(j) - state.x.row(i)) / rest;
        const Vec3 next = (features.base.row(j) - features.base.row(i)) / rest;
        put(features.edge, e, 0, now);
        put(features.edge, e, 3, now.norm() - 1.0);
        put(features.edge, e, 4, next);
        put(features.edge, e, 7, next.norm() - 1.0);
        put(features.edge, e, 8, std::log(rest));
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
        put(features.world, i, 0, per_metre * now);
        put(features.world, i, 3, per_metre * now.norm());
        put(features.world, i, 4, per_metre * next);
        put(features.world, i, 7, per_metre * next.norm());
        put(features.world, i, 8, per_metre * velocity);
        put(features.world, i, 11, normal);
        put(features.world, i, 14, per_metre * contacts.distance[i]);
        put(features.world, i, 15, per_metre * distance);
        // Contact is felt within a fraction of eps: resolved apart from the distance in
        // centimetres.
        put(features.world, i, 16, std::tanh((distance - eps) / (0.25 * eps)));
        put(features.body, i, 0, per_metre * velocity);
        put(features.body, i, 3, normal);
        const auto& obstacle =
            boundary.obstacles[static_cast<size_t>(contacts.obstacle[static_cast<size_t>(i)])];
        put(features.body, i, 6, obstacle.friction);
    }
}

}  // namespace cloth
