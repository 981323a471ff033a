#pragma once

#include <string>
#include <vector>

#include "bullet_ext/bodySegments.h"
#include "collision/self/self_contact_settings.h"
#include "data/core/boundary.h"
#include "data/core/cloth_state.h"

namespace cloth {

/// What all solvers of a comparison are given: a garment, and the outside over time.
///
/// The clock starts with the first frame that is compared. Before it may lie a lead-in, in which
/// the garment settles (see settle()).
class ComparisonScene {
 public:
    virtual ~ComparisonScene() = default;
    ComparisonScene(const ComparisonScene&) = delete;
    ComparisonScene& operator=(const ComparisonScene&) = delete;

    const Garment& garment() const { return m_garment; }
    int rate() const { return m_rate; }                          ///< frames per second
    double frame_time() const { return 1.0 / m_rate; }           ///< (s), of a step
    int frames() const { return m_frames; }                      ///< that solvers compute
    int reference_frames() const { return m_reference_frames; }  ///< of them with references

    /// The outside between two times (s); negative times lie in the lead-in.
    virtual Boundary boundary(double t0, double t1) const = 0;
    Boundary frame_boundary(int frame) const {
        return boundary(frame * frame_time(), (frame + 1) * frame_time());
    }

    /// Where the garment is before the lead-in.
    virtual ClothState start() const { return ClothState::at_rest(m_garment); }

    /// Frames in which the garment settles from its start; 0: it is measured from its start on.
    virtual int lead_in_frames() const { return 0; }

    /// Whether the garment keeps off itself; solvers that know nothing of it go without.
    virtual SelfContactSettings self_contact() const { return {}; }

    /// Whether obstacles have limbs that cloth may pass through, see LimbOverlap.
    virtual bool has_limbs() const { return false; }

    /// Hulls of the animated body for Bullet's own solver; none: Bullet has the obstacles' shapes.
    virtual std::vector<BodySegment> segments() const { return {}; }

    /// Why a garment at x (|V| x 3, m) at the end of the step does not belong to the scene any
    /// more, such as "slid off the body"; empty: it does.
    virtual std::string loss(const Boundary&, const Points& /*x*/) const { return {}; }

 protected:
    explicit ComparisonScene(Garment garment, int rate = 30)
        : m_garment(std::move(garment)), m_rate(rate) {}

    /// @param reference_frames  at most `frames`
    void set_length(int frames, int reference_frames) {
        m_frames = frames;
        m_reference_frames = reference_frames;
    }

 private:
    Garment m_garment;
    int m_rate;
    int m_frames = 0;
    int m_reference_frames = 0;
};

}  // namespace cloth
