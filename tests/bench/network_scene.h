#pragma once

#include <memory>

#include "data/body/animated_body.h"
#include "gnn/graph/features.h"
#include "gnn/model/model_config.h"
#include "gnn/physics/stepper/cloth_stepper.h"

namespace cloth::test {

inline constexpr double dt = 1.0 / 30.0;  ///< s, of the motion's steps

/// The T-shirt (3,991 vertices), on the default body and motion 01_01, frame by frame. Without
/// assimp-testmodels: on a sphere that fills it.
class TshirtMotion {
 public:
    static Garment load_garment();
    /// Keeps a reference to `garment`.
    explicit TshirtMotion(const Garment& garment);

    const Boundary& boundary() const { return m_boundary; }  ///< of the next step
    const ClothState& state() const { return m_state; }
    void step();

 private:
    void show_obstacle();

    ClothStepper m_stepper;
    std::unique_ptr<AnimatedBody> m_body;  ///< null: the sphere
    Boundary m_boundary;
    ClothState m_state;
    int m_frame = 0;
};

/// TshirtMotion after 44 frames.
struct TshirtMoment {
    TshirtMoment();
    Garment garment;
    Boundary boundary;
    ClothState state;
};

/// The moment as a network of this configuration sees it.
struct NetworkInput {
    NetworkInput(const TshirtMoment& moment, const ModelConfig& config);
    ClothGraph graph;
    Features features;
};

/// Multiply-adds of the matrix products of one evaluation as the engine arranges it (split first
/// layer, no message that nobody reads), times two; everything else is not counted.
struct NetworkFlops {
    double encoder = 0.0, edges = 0.0, products = 0.0, world = 0.0, nodes = 0.0, decoder = 0.0;
    double total() const { return encoder + edges + products + world + nodes + decoder; }
};
NetworkFlops network_flops(const ModelConfig& config, const ClothGraph& graph,
                           const Features& features);

}  // namespace cloth::test
