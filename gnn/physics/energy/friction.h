#pragma once

#include <algorithm>
#include <vector>

#include "collision/proximity/proximity.h"
#include "data/core/cloth_state.h"
#include "gnn/physics/energy/block_pattern.h"

namespace cloth {

/// What the limits of normal forces are multiples of (m/s^2): gravity, but no less than the
/// Earth's. A tight band presses as much on the Moon.
inline double limiting_acceleration(const Vec3& gravity) {
    constexpr double standard_gravity = 9.80665;
    return std::max(gravity.norm(), standard_gravity);
}

/// What friction needs to know beside the obstacles' own coefficients.
struct FrictionSettings {
    double scale = 1.0;           ///< multiplies the obstacles' coefficients; 0: no friction
    double distance = 6e-3;       ///< acts on vertices closer than this at t (m)
    double slip = 1e-4;           ///< slip (m) below which friction is smoothed
    double contact_distance = 0;  ///< eps of the contact energy (m)
    double contact_weight = 0;    ///< w of the contact energy (N/m^2)
    double pressure_limit = 10;   ///< largest normal force, in units of the vertex's mass times
                                  ///< limiting_acceleration()
    double pinch_pressure = 0;    ///< on vertices that are pinched (Pa), see Boundary::pinched
};

/// Coulomb friction as a lagged dissipative potential,
///
///     E = sum mu N_i (sqrt(s^2 + |u_i|^2) - s),
///
/// where u_i is the tangential part of the vertex's motion since t relative to the surface below it
/// (where that would take it from t to t + dt, see carried_motion()) and of the slip that it began
/// the step with, s the smoothing slip, mu the obstacle's coefficient.
///
/// The slip that a step begins with is what the last one ended with, up to 3 s: cloth that is
/// pulled by less than 0.95 mu N stays where it is for good, and does not creep. It is shortened
/// further where it would store more energy than it did at the end of the last step, because N or s
/// have changed: a contact that is pressed in turns gives no energy. (The bristles of elastoplastic
/// friction: Dupont, Hayward, Armstrong and Altpeter, Single state elastoplastic friction models,
/// 2002.)
///
/// N_i, fixed at t, is the larger of two estimates: the weight that the surface carries, m |g|
/// max(0, n . up), exact for cloth lying on it; and the contact force 3 w depth^2 at x_t, which
/// also holds on vertical surfaces. The second is limited, because a vertex half a millimetre too
/// deep in an unconverged state would otherwise be glued by a thousand times its weight. The limit
/// stays where there is little gravity or none, for it is not gravity that presses there. Of
/// vertices that are pinched between two skins it is at least the skins' pressure on their area.
///
/// HOOD's friction has the same form with three defects that are not kept: its radius is compared
/// with squared distances, its up axis is not gravity's, and its body moves one frame late.
class FrictionEnergy {
 public:
    void begin_step(const Garment& garment, const ClothState& state, const Boundary& boundary,
                    const SurfaceContacts& contacts, const FrictionSettings& settings);

    /// @param x  |V| x 3 (m)
    double value(const Points& x) const;
    /// Adds dE/dx (|V| x 3, N) to `gradient` and returns the energy (J).
    double add_gradient(const Points& x, Points& gradient) const;
    /// Adds the Hessian (N/m), positive semi-definite by itself, to a matrix of `pattern`.
    void add_hessian(const Points& x, const BlockPattern& pattern, double* values) const;

    /// What the next step begins with if this one ends at x.
    void remember(const Points& x, StickMemory& memory) const;

    /// A vertex that friction acts on.
    struct Slider {
        Eigen::Index vertex;
        Vec3 normal;   ///< mean of the surface's normals at t and t + dt
        Vec3 stick;    ///< where the vertex would be at t + dt if it had always stuck (m)
        double force;  ///< mu N (N)
    };
    const std::vector<Slider>& sliders() const { return m_sliders; }
    double slip() const { return m_slip; }  ///< s (m)

 private:
    std::vector<Slider> m_sliders;
    double m_slip = 1e-4;
};

}  // namespace cloth
