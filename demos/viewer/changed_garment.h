#pragma once

#include <memory>
#include <utility>

#include "demos/compare/comparison_scene.h"

namespace cloth {

/// A scene whose garment has another fabric, or goals: all else is as it was.
class ChangedGarment : public ComparisonScene {
 public:
    ChangedGarment(std::shared_ptr<const ComparisonScene> scene, Garment garment)
        : ComparisonScene(std::move(garment), scene->rate()), m_scene(std::move(scene)) {
        set_length(m_scene->frames(), m_scene->reference_frames());
    }

    Boundary boundary(double t0, double t1) const override { return m_scene->boundary(t0, t1); }
    ClothState start() const override { return m_scene->start(); }
    int lead_in_frames() const override { return m_scene->lead_in_frames(); }
    SelfContactSettings self_contact() const override { return m_scene->self_contact(); }
    bool has_limbs() const override { return m_scene->has_limbs(); }
    std::vector<BodySegment> segments() const override { return m_scene->segments(); }
    std::string loss(const Boundary& boundary, const Points& x) const override {
        return m_scene->loss(boundary, x);
    }

 private:
    std::shared_ptr<const ComparisonScene> m_scene;
};

}  // namespace cloth
