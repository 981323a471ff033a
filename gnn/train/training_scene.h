#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "collision/proximity/proximity.h"
#include "gnn/graph/features.h"
#include "gnn/physics/solver/quasi_newton.h"
#include "gnn/physics/stepper/embedded_stepper.h"

namespace cloth {

/// The outside of a training scene: obstacles and pin targets as functions of time.
class TrainingWorld {
 public:
    virtual ~TrainingWorld() = default;

    /// The step from `time` to `time` + dt (s).
    virtual void boundary(double time, double dt, Boundary& out) = 0;
};

/// What a scene is made of.
struct SceneParts {
    std::string kind;  ///< "sheet" or "garment", for logs
    std::uint64_t seed = 0;
    std::shared_ptr<const Garment> garment;
    std::shared_ptr<const ClothGraph> graph;
    std::shared_ptr<const Garment> proxy;  ///< each step starts where this coarser garment shows
                                           ///< the other, see EmbeddedStepper; null: at the guess
    std::unique_ptr<TrainingWorld> world;
    ClothState start;
    int warm_up = 0;  ///< frames that the solver advances before the network sees the scene
    int life = 90;    ///< frames until the scene is replaced
};

/// One garment in its world, with everything that a training step needs of it.
class TrainingScene {
 public:
    TrainingScene(SceneParts parts, const FeatureSettings& features, double dt);

    /// Contacts, potential, guess and features of the step from the current state.
    void prepare(double contact_weight);

    /// Quasi-Newton iterations on the prepared step, in place; returns the energy reached (J).
    double refine(Points& x, int iterations);

    /// Takes `x` (|V| x 3, m) as the end of the prepared step. False: the garment is torn apart or
    /// not finite, and the scene must be replaced.
    bool advance(const Points& x);

    /// Advances the solver alone by parts().warm_up frames.
    void warm_up(int iterations, double contact_weight);

    const SceneParts& parts() const { return m_parts; }
    const Garment& garment() const { return *m_parts.garment; }
    const ClothGraph& graph() const { return *m_parts.graph; }
    const IncrementalPotential& potential() const { return m_potential; }
    const Boundary& boundary() const { return m_boundary; }
    const Features& features() const { return m_features; }
    const Eigen::SparseMatrix<double>& laplacian() const { return m_laplacian; }
    double dt() const { return m_dt; }

    ClothState state;
    int age = 0;  ///< frames since the start, warm-up not counted

 private:
    bool is_sound(const Points& x) const;
    bool start_at_proxy();
    void start_at_guess();

    SceneParts m_parts;
    double m_dt;
    Proximity m_proximity;
    IncrementalPotential m_potential;
    QuasiNewton m_solver;
    FeatureBuilder m_builder;
    Eigen::SparseMatrix<double> m_laplacian;
    std::unique_ptr<EmbeddedStepper> m_proxy;
    Boundary m_boundary;
    SurfaceContacts m_contacts;
    Points m_guess;
    Features m_features;
};

}  // namespace cloth
