#pragma once

#include "data/core/boundary.h"
#include "data/core/cloth_state.h"
#include "gnn/graph/cloth_graph.h"
#include "gnn/graph/feature_layout.h"
#include "gnn/physics/energy/incremental_potential.h"

namespace cloth {

/// Which features the network has; part of the model's configuration, equal in training and use.
struct FeatureSettings {
    bool force_features =
        true;  ///< forces at x_t and at the base guess, besides the paper's features
    double world_radius = 0.03;  ///< obstacles nearer than this send messages (m), 1e-3 to 1
};

/// Input of the network for one step, not normalised, each quantity without dimension. A virtual
/// body node stands at the surface point nearest to each garment vertex, so rows of `world` and
/// `body` belong to the garment vertex of the same number and count only where world_mask is 1.
struct Features {
    MatrixF node;        ///< |V| x columns of node_layout()
    MatrixF edge;        ///< |E| x columns of edge_layout(), order of ClothGraph
    MatrixF world;       ///< |V| x columns of world_layout()
    MatrixF body;        ///< |V| x columns of body_layout()
    VectorF world_mask;  ///< |V|: 1 or 0
    bool any_world = false;
    Points base;         ///< |V| x 3 (m): the guess that the network's output is added to
    double scale = 0.0;  ///< metres per unit of the network's output
};

/// Length that accelerations of one g or so move a vertex in a step (m): the network's unit.
inline double output_scale(double dt) {
    return 10.0 * dt * dt;
}

/// Turns the start of a step into the network's input. Written once for trainer and engine. Owns
/// its scratch memory: no allocation once the sizes are known.
class FeatureBuilder {
 public:
    explicit FeatureBuilder(const Garment& garment, const ClothGraph& graph,
                            FeatureSettings settings = {});

    /// @param potential  begun for this step, with the nearest points of state.x
    /// @param base       |V| x 3 (m): the guess, with pinned vertices at their targets
    /// @param at_base    if not null, filled with E and its gradient at the base where the features
    ///                   need them; returns whether they do
    bool build(const ClothState& state, const Boundary& boundary,
               const IncrementalPotential& potential, const Points& base, Features& features,
               PotentialValue* at_base = nullptr);

 private:
    void build_nodes(const ClothState& state, const Boundary& boundary,
                     const IncrementalPotential& potential, Features& features);
    void build_forces(const ClothState& state, const IncrementalPotential& potential,
                      Features& features, PotentialValue& at_base);
    void build_edges(const ClothState& state, Features& features) const;
    void build_world(const ClothState& state, const Boundary& boundary,
                     const IncrementalPotential& potential, Features& features) const;

    const Garment* m_garment;
    const ClothGraph* m_graph;
    FeatureSettings m_settings;
    VectorF m_log_mass;         ///< |V|
    VectorF m_log_rest_length;  ///< |E|
    Vec3 m_material;            ///< bending, mu, lambda scaled to [0, 1] over the training range
    Points m_normals, m_elastic_now, m_elastic_base;
    PotentialValue m_at_base;
};

}  // namespace cloth
