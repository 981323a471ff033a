#pragma once

#include <vector>

#include "collision/response/resolve.h"

namespace cloth {

struct SkinBlendSettings {
    double distance = 5e-4;  ///< of shown vertices from obstacles (m), 0 to 5e-3
    double deepest = 0.2;    ///< a vertex that is mixed deeper into a mesh than this stays there
                             ///< (m), 0.01 to 1; larger costs time
    int threads = 0;         ///< of the queries, see ProximitySettings

    /// @throws ArgumentError naming the field that is out of range
    void check() const;
};

/// What is shown of a garment: by a weight between where it is simulated (0) and where its skin
/// takes it (1), and never inside an obstacle. The weight changes at once, or fades in time:
///
///     SkinBlend blend;
///     blend.fade_to(1.0, 0.5);                        // skinned in half a second
///     stepper.step(boundary, dt, state);
///     blend.advance(dt);
///     blend.follow(state.x, boundary.goals.x1, boundary, stepper.ignored_limbs());
///     draw(blend.vertices());
///
/// The state of the cloth is not touched, so it goes on as if nobody mixed anything, and is there
/// when the weight returns to 0. A mixed state would be neither: its velocities are of no motion,
/// contacts and goals would pull it back in the next step, and a weight of 1 would be a pin. To
/// hold the state itself near the skin there is GoalLimits::max_distance.
///
/// The mixture of two places outside of a limb can be inside of it, so it is pushed out, as
/// EmbeddedMesh is. A vertex that no push brings out is shown where it is simulated.
class SkinBlend {
 public:
    /// @throws ArgumentError if a setting is out of range
    explicit SkinBlend(const SkinBlendSettings& settings = {});

    /// The weight changes steadily from what it is now.
    /// @param weight   0: simulated, 1: skinned
    /// @param seconds  0 to 1e6; 0: at once
    /// @throws ArgumentError if one is out of range
    void fade_to(double weight, double seconds = 0.0);
    /// Lets time pass (s, 0 or more; other numbers do nothing).
    void advance(double dt);
    double weight() const { return m_weight; }
    bool is_fading() const { return m_left > 0.0; }

    /// @param simulated  |V| x 3 (m), outside of the obstacles
    /// @param skinned    |V| x 3 (m), such as the goals at the end of the step; where they do not
    ///                   fit or are not finite, the garment is shown as simulated
    /// @param boundary   obstacles at the end of its step
    /// @param ignored    limbs that each vertex ignores (|V|), or empty
    /// Where `simulated` is not finite, what is shown stays as it was.
    ResolveReport follow(const Points& simulated, const Points& skinned, const Boundary& boundary,
                         const std::vector<LimbSet>& ignored = {});

    const Points& vertices() const { return m_x; }  ///< |V| x 3 (m), of the last follow()

 private:
    SkinBlendSettings m_settings;
    double m_weight = 0.0, m_target = 0.0;
    double m_left = 0.0;  ///< until the target is reached (s)
    Proximity m_proximity;
    SurfaceContacts m_contacts;
    Points m_x;
};

}  // namespace cloth
