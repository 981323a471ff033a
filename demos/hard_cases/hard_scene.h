#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "demos/compare/comparison_scene.h"

namespace cloth {

/// What a hard case is made of: the only thing that a case has to say.
struct HardSceneParts {
    Garment garment;
    ClothState start;
    std::function<Boundary(double t0, double t1)> outside;  ///< between two times (s)
    double dt = 1.0 / 30.0;                                 ///< time step (s)
    std::vector<BodySegment> segments = {};                 ///< of an animated body, for Bullet
    /// Why a garment at x does not belong to the scene any more, such as "fell through"; optional.
    std::function<std::string(const Boundary&, const Points& x)> loss = nullptr;
    SelfContactSettings self_contact = {};
    bool limbs = false;  ///< of obstacles: cloth may pass through them, see LimbOverlap
};

/// A hard case as all solvers of the reports are given their scenes. Frames are as long as the
/// case's own time step.
class HardScene : public ComparisonScene {
 public:
    HardScene(HardSceneParts parts, int frames)
        : ComparisonScene(parts.garment), m_parts(std::move(parts)) {
        set_length(frames, 0);
    }

    double dt() const { return m_parts.dt; }
    ClothState start() const override { return m_parts.start; }

    /// One of the case's starts: 0 is start(), in the others each free vertex is off by up to
    /// 1e-7 m along each axis. A run that depends on so little is held, or not, by chance.
    ClothState start_from(int which) const;

    Boundary boundary(double t0, double t1) const override { return m_parts.outside(t0, t1); }
    Boundary boundary_of_frame(int frame) const {
        return boundary(frame * dt(), (frame + 1) * dt());
    }
    SelfContactSettings self_contact() const override { return m_parts.self_contact; }
    bool has_limbs() const override { return m_parts.limbs; }
    std::vector<BodySegment> segments() const override { return m_parts.segments; }
    std::string loss(const Boundary& boundary, const Points& x) const override {
        return m_parts.loss ? m_parts.loss(boundary, x) : std::string();
    }

 private:
    HardSceneParts m_parts;
};

}  // namespace cloth
