#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "collision/proximity/surface_samples.h"
#include "collision/response/pinch_sides.h"
#include "collision/response/plane_push.h"
#include "collision/response/resolve.h"
#include "collision/response/strain_limiter.h"

namespace cloth {

struct ContactProjectionSettings {
    double allowed_depth = 5e-4;  ///< edge midpoints and face centres deeper than this (m) are
                                  ///< pushed out to it, 0 to 5e-3
    int iterations = 12;  ///< rounds of search and push, 0 to 100; 0: vertices alone. Cloth in
                          ///< contact takes 1 or 2, cloth that is pinched one for each ring of
                          ///< vertices that has to change sides
    int sweeps = 40;      ///< of PlanePush in each, 1 to 1000
    double most = 3.0;    ///< no vertex moves further in a round than this times the largest depth,
                          ///< 1 to 10
    double growth = 0.03;  ///< edges near what is pushed out may become longer by this share of
                           ///< their length before, or at rest, 0.01 to 1
};

/// Contact projection of a step, for the whole surface of a garment: leaves no vertex inside an
/// obstacle, and no edge midpoint or face centre deeper than a tolerance.
///
///     ContactProjection resolver(garment);
///     ResolveReport report = resolver.resolve(proximity, boundary, 5e-4, x, contacts);
///     if (report.deepest_after() > 1e-3) { ... the cloth is caught: see below ... }
///
/// Vertices go first, as in resolve_penetration(). Then samples that are too deep are lifted by the
/// smallest motion of their vertices that also keeps those outside, and the vertices that moved are
/// checked again. Pinned vertices never move; x without deep samples keeps its bits.
///
/// They leave by the nearest way, unless it is known where they went in: a face that a fingertip
/// pierced is nearest to the sides of the finger, and would stay on it.
///
/// It cannot succeed where cloth has nowhere to go, such as between two bodies that close on it.
/// The report says so, and x is then what had the least depth plus excess of
/// length of an edge.
class ContactProjection {
 public:
    /// @throws ArgumentError if a setting is out of range
    explicit ContactProjection(const Garment& garment,
                               const ContactProjectionSettings& settings = {});

    /// Outside of where a deep sample went in; none: unknown.
    using WayIn = std::function<std::optional<HalfSpace>(const SurfaceSamples&, int sample)>;

    /// Whether edges and faces are kept out from now on, as at first, if the settings say so.
    void set_surface(bool on) { m_surface = on; }

    /// @param distance  of vertices from the surfaces at t + dt (m, small: 0 to 1e-3)
    /// @param x         |V| x 3 (m), the pinned vertices in place
    /// @param contacts  the nearest points of the resulting `x`, chosen at t + dt (without
    /// obstacles
    ///                  it is left as it is)
    /// @param way_in    null: no way is known
    ResolveReport resolve(Proximity& proximity, const Boundary& boundary, double distance,
                          Points& x, SurfaceContacts& contacts, const WayIn& way_in = nullptr);

 private:
    void resolve_surface(Proximity& proximity, const Boundary& boundary, double distance, Points& x,
                         SurfaceContacts& contacts, const WayIn& way_in, ResolveReport& report);
    void push_samples(double distance, Points& x, const SurfaceContacts& contacts,
                      const WayIn& way_in);
    bool push_back(int sample, const WayIn& way_in);
    void hold_vertices(const std::vector<int>& samples, double distance, const Points& x,
                       const SurfaceContacts& contacts);
    void push_vertices(Proximity& proximity, const Boundary& boundary, double distance, Points& x,
                       SurfaceContacts& contacts);
    double depth_of_free(const SurfaceContacts& contacts) const;

    ContactProjectionSettings m_settings;
    bool m_surface = true;
    SurfaceSamples m_samples;
    PinchSides m_sides;
    PlanePush m_push;
    StrainLimiter m_guard;
    std::vector<int> m_free;              ///< vertices that are not pinned
    std::vector<char> m_pinned;           ///< |V|
    std::vector<char> m_changed, m_held;  ///< |V|: moved in this round; has planes
    std::vector<int> m_rows, m_pinched;
    Points m_best;  ///< |V| x 3 (m)
};

}  // namespace cloth
