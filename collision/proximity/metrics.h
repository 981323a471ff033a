#pragma once

#include "collision/proximity/proximity.h"
#include "data/core/garment.h"

namespace cloth {

/// How far a garment is inside the obstacles.
struct PenetrationStatistics {
    static constexpr double tolerance = 1e-3;  ///< shallower than this (m) does not count as inside

    double max_depth = 0.0;        ///< deepest of vertices, edge midpoints and face centres (m)
    double vertex_depth = 0.0;     ///< deepest vertex (m)
    double fraction_inside = 0.0;  ///< of the vertices, deeper than the tolerance
    double edge_fraction = 0.0;    ///< of the edge midpoints
    double face_fraction = 0.0;    ///< of the face centres
};

/// Penetration of positions x (|V| x 3, m) into the surfaces at one end of the step.
///
/// A point that is deeper inside a mesh than the radius of `proximity` counts as outside (see
/// Proximity): measure with a radius of half the thickest part of the obstacles.
PenetrationStatistics measure_penetration(Proximity& proximity, const Boundary& boundary,
                                          const Garment& garment, const Points& x,
                                          StepEnd end = StepEnd::end);

/// Edge lengths over rest lengths: 1 is unstretched.
struct StretchStatistics {
    double p50 = 1.0, p99 = 1.0, max = 1.0;
};

/// Percentiles by nearest rank over all edges; edges without rest length are left out.
StretchStatistics measure_stretch(const Garment& garment, const Points& x);

/// How much a garment trembles from frame to frame.
///
///     JitterMeter jitter;
///     for (const ClothState& frame : frames) jitter.add(frame.x);
///     double trembling = jitter.mean();
///
/// Per vertex and frame, |x_t - 3 x_{t-1} + 3 x_{t-2} - x_{t-3}| / 8: zero for any motion of
/// constant acceleration, and the amplitude of positions that alternate from one frame to the next.
class JitterMeter {
 public:
    void add(const Points& x);

    double last() const { return m_last; }  ///< RMS over the vertices in the last frame (m)
    double mean() const;                    ///< RMS over all frames that have three before them (m)

 private:
    Points m_before[3];  ///< the last three frames, latest first
    int m_frames = 0;
    double m_last = 0.0;
    double m_sum_of_squares = 0.0;
};

}  // namespace cloth
