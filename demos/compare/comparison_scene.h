#pragma once

#include <memory>
#include <string>

#include "data/animated_body.h"
#include "data/boundary.h"
#include "data/cloth_state.h"
#include "demos/compare/options.h"

namespace cloth {

/// What all solvers of a comparison are given: a garment on a moving body.
///
/// The clock starts with the motion; before it lies the lead-in, in which the body moves from its
/// rest pose into the motion's first pose and the garment settles.
class ComparisonScene {
 public:
    static constexpr double frame_time = 1.0 / 30.0;  ///< (s)

    /// @throws LoadError, ArgumentError, UsageError if the garment or the motion cannot be had
    explicit ComparisonScene(const CompareOptions& options);

    const Garment& garment() const { return *m_garment; }
    const AnimatedBody& body() const { return *m_body; }
    int frames() const { return m_frames; }                      ///< of the motion
    int reference_frames() const { return m_reference_frames; }  ///< with references
    int lead_in_frames() const { return m_lead_in_frames; }

    /// The outside between two times (s) of the motion's clock; negative times lie in the lead-in.
    Boundary boundary(double t0, double t1) const;

    /// Skin of the body at a time of the motion's clock (|V| x 3, m).
    Points skin(double time) const;

 private:
    std::unique_ptr<Garment> m_garment;
    std::unique_ptr<AnimatedBody> m_body;
    int m_frames = 0;
    int m_reference_frames = 0;
    int m_lead_in_frames = 30;
};

Fabric fabric_named(const std::string& name);

}  // namespace cloth
