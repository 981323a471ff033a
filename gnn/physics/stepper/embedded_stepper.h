#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "collision/response/contact_projection.h"
#include "collision/response/goal_projection.h"
#include "data/core/mesh_embedding.h"
#include "gnn/physics/stepper/step_start.h"
#include "gnn/stepper.h"

namespace cloth {

class StepSolver;

struct EmbeddedStepperSettings {
    MeshEmbeddingSettings embedding;
    double fade = 0.1;    ///< time in which what the proxy cannot show of a state that it is given
                          ///< fades to a third (s), 0 to 10; 0: at once
    bool surface = true;  ///< edges and faces of the fine garment are kept out of obstacles, too;
                          ///< false: vertices alone, and max_penetration is theirs. That costs less
    /// The same for the proxy, which is not shown. Without, a step costs less, and what is fast and
    /// thin gets through more often.
    bool proxy_surface = true;
    ProximitySettings proximity;  ///< of the fine garment
    /// Iterations of the fine garment's own step, from where the proxy shows it, 0 to 1000. The
    /// first takes away most of the stretch that the proxy's shape brings; folds that are finer
    /// than the proxy's edges take many. 0: none, unless there is a network.
    int detail_iterations = 0;
};

/// Simulates a coarse garment, the proxy, by any stepper and lets a fine one follow it: simulate
/// coarse, show fine. To whoever steps it, it is a stepper of the fine garment.
///
///     const auto proxy = std::make_shared<const Garment>(make_proxy(shirt));
///     EmbeddedStepper stepper(shirt, proxy, make_cloth(*proxy));
///     stepper.step(boundary, dt, state);  // of the shirt
///
/// The fine garment is where its places over the proxy are (MeshEmbedding). Then contact projection
/// and goal projection move it as they do at the end of any step, its pins are at their targets,
/// and its velocities are its motion over the step. It has no motion of its own: wrinkles finer
/// than the proxy's edges are not there, and it does not keep off itself: the proxy does, if its
/// stepper has self-contact.
///
/// With detail it has: its own step starts where the proxy shows it, and a network, some
/// iterations, or both lower its own energy from there, up to a mean edge of the proxy away. The
/// proxy does not feel that.
///
/// The proxy's state is carried from step to step, as long as the fine positions are what this
/// stepper returned last; what was done to their velocities is done to the proxy's. For any other
/// state, the first one among them, it is derived: the proxy's places
/// over the fine mesh say where it is and how it moves. What the proxy cannot show of that state,
/// such as fine wrinkles, is kept as an offset and fades, so that nothing jumps.
///
/// Of the outside, the proxy has the obstacles, and at its places means of the accelerations, of
/// goals, of pin targets, and all limbs that are ignored around them. Reports: iterations are those
/// of both; gain, convergence, entry and tangles are the proxy's; penetration, goals and ignored
/// limbs are those of the fine garment; the residual is left out. It gives no internal forces:
/// those of the fine garment do not move it.
class EmbeddedStepper : public Stepper {
 public:
    /// @param fine   a reference is kept
    /// @param proxy  at rest in the same place, such as make_proxy() or carry_over() make it
    /// @param stepper  of the proxy
    /// @param detail   a network for the fine garment, such as a NetworkStart; null: none. It is
    ///                 asked in steps of its own length, and if iterations follow, heard only where
    ///                 it lowers the energy
    /// @throws ArgumentError if a setting is out of range, the meshes are not in the same place,
    ///         only one of the garments has pins or goals, or there is no stepper
    EmbeddedStepper(const Garment& fine, std::shared_ptr<const Garment> proxy,
                    std::unique_ptr<Stepper> stepper, const EmbeddedStepperSettings& settings = {},
                    const std::shared_ptr<StepStart>& detail = nullptr);
    ~EmbeddedStepper() override;

    /// That of the proxy's stepper, and after "~" the number of the proxy's vertices.
    std::string name() const override;
    /// The proxy's, or else the network's.
    double fixed_dt() const override;
    bool accepts_any_dt() const override { return m_stepper->accepts_any_dt(); }
    void prepare(double dt) override;
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override;
    bool is_independent() const override;
    /// Of the proxy's step: what the fine garment takes comes on top.
    bool set_max_ms(double ms) override { return m_stepper->set_max_ms(ms); }
    /// Of the proxy's step, and of the fine garment's own.
    bool set_max_iterations(int most) override;
    bool set_most_residual(double most) override { return m_stepper->set_most_residual(most); }
    bool set_surface_projection(bool on) override {
        m_contact_projection.set_surface(on);
        return true;
    }
    const std::vector<LimbSet>& ignored_limbs() const override { return m_ignored; }

    const Garment& proxy() const { return *m_proxy; }
    const ClothState& proxy_state() const { return m_state; }  ///< after the last step

    /// Where the proxy shows the fine garment at the end of a step from `state`, before the fine
    /// garment's own step and projection. The proxy begins at what it can show of `state`, whatever
    /// was stepped before. False: it failed.
    /// @param x  |V| x 3 (m)
    bool shown_from(const Boundary& boundary, double dt, const ClothState& state, Points& x);

 private:
    /// A pin of the proxy hangs between some of the fine pins.
    struct HeldPin {
        std::array<int, 3> pins{};  ///< places in Garment::pins() of the fine garment
        Vec3 weights = Vec3::Zero();
    };

    void find_pins();
    void push(const Points& v);
    void derive(const ClothState& state);
    StepReport step_proxy(const Boundary& boundary, double dt, const ClothState& state);
    void take_boundary(const Boundary& boundary);
    Points of_proxy(const Points& fine) const;
    void take_ignored(const Boundary& boundary);
    void show(const Boundary& boundary, double dt, ClothState& state, StepReport& report);
    void add_detail(double dt, ClothState& state, StepReport& report);
    void limit_detail();
    void measure_ignored(const Boundary& boundary, StepReport& report);

    const Garment* m_fine;
    EmbeddedStepperSettings m_settings;
    std::shared_ptr<const Garment> m_proxy;
    std::unique_ptr<Stepper> m_stepper;
    MeshEmbedding m_places;                  ///< of the fine vertices over the proxy
    MeshEmbedding m_proxy_places;            ///< of the proxy's vertices over the fine mesh
    std::vector<HeldPin> m_pins;             ///< of the proxy
    ClothState m_state;                      ///< of the proxy
    std::shared_ptr<ObstacleTrees> m_trees;  ///< where Boundary::trees is null
    Boundary m_proxy_boundary;
    Boundary m_outside;  ///< of the fine garment
    ClothState m_shown;  ///< as returned last; without rows: nothing was
    Points m_offset;     ///< |V| x 3 (m): what the proxy could not show of the state it was given
    Points m_x;          ///< |V| x 3 (m)
    std::vector<LimbSet> m_ignored;  ///< |V|, or empty
    Proximity m_proximity;
    ContactProjection m_contact_projection;
    GoalProjection m_goal_projection;
    SurfaceContacts m_contacts;
    std::vector<int> m_rows;
    std::unique_ptr<StepSolver> m_detail;  ///< of the fine garment; null: it has no own step
    double m_most_detail;                  ///< (m): how far that moves a vertex off the proxy
    Points m_embedded;                     ///< |V| x 3 (m): where the proxy's shape is
};

}  // namespace cloth
