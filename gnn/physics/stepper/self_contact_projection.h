#pragma once

#include <optional>

#include "collision/self/self_resolve.h"
#include "collision/self/self_tangles.h"
#include "gnn/physics/stepper/passing_vertices.h"
#include "gnn/physics/stepper/untangling.h"
#include "gnn/stepper.h"

namespace cloth {

/// What a stepper does for self-contact at the end of a step, after its obstacles: layers that
/// passed through each other are put back, and tangles are counted for the report. Does nothing,
/// and holds nothing, where self-contact is off.
class SelfContactProjection {
 public:
    /// @throws ArgumentError if a setting is out of range
    SelfContactProjection(const Garment& garment, const SelfContactSettings& settings);

    /// Before each finish().
    /// @param x0          |V| x 3 (m): positions at t
    /// @param overlapped  see Boundary
    /// @return  |V|, or empty: vertices that no other cloth should repel in this step, since they
    ///          may be on the wrong side of it. Valid until the next call
    const std::vector<char>& begin_step(const Points& x0, const std::vector<char>& overlapped);

    /// @param x0       |V| x 3 (m): as in begin_step()
    /// @param outside  its goals have the last word
    /// @param x        |V| x 3 (m): positions at t + dt, pins in place
    /// @param report   max_penetration is brought up to date
    void finish(const Points& x0, const Untangling::Surroundings& outside, Points& x,
                StepReport& report);

    /// Counts them in `report`, at the end of all, but for those at overlapped vertices. Does not
    /// look for them where x is what the last finish() made of positions without any, and nothing
    /// passed through anything.
    void count_tangles(const Points& x, const std::vector<char>& overlapped, StepReport& report);

    /// Untangles what the last count_tangles() counted, if the settings say so, and counts again.
    /// @param state  as the step leaves it, at the positions that were counted
    void untangle(const Untangling::Surroundings& outside, double dt, ClothState& state,
                  StepReport& report);

    bool on() const { return m_tools.has_value(); }
    /// What the last finish() had to do.
    const SelfResolveReport& last() const { return m_last; }

 private:
    const std::vector<Tangle>* tangles_at(const Points& x);
    void part_layers(const Points& x0, const Untangling::Surroundings& outside, bool tangled,
                     Points& x, StepReport& report);
    double depth_of_moved(const SurfaceContacts& contacts);
    void keep(const std::vector<Tangle>& tangles, const Points& x);
    void report_tangles(const std::vector<Tangle>& tangles, const Points& x,
                        const std::vector<char>& overlapped, StepReport& report);

    struct Tools {
        SelfResolver resolver;
        SelfTangles tangles;
        PassingVertices passing;
    };
    std::optional<Tools> m_tools;
    std::optional<Untangling> m_untangling;
    SelfContactSettings m_settings;
    std::vector<char> m_pinned;
    std::vector<int> m_rows;
    SurfaceContacts m_none;  ///< where there are no obstacles
    SelfResolveReport m_last;
    std::vector<Tangle> m_left;  ///< the tangles at m_tangled
    Points m_tangled;            ///< |V| x 3 (m): where they were looked for last
    Points m_untangled;          ///< |V| x 3 (m): positions at which there are none, or empty
    Points m_next_untangled;     ///< as the last finish() knows them
};

}  // namespace cloth
