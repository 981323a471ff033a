#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bullet_ext/bodySegments.h"
#include "bullet_ext/garmentSoftBody.h"
#include "gnn/stepper.h"

namespace cloth {

/// How Bullet's own cloth is run as a baseline.
struct BulletClothSettings {
    std::string name = "bullet";
    double substep_dt = 1.0 / 60.0;  ///< a step is cut into equal sub-steps of about this (s),
                                     ///< 1e-4 to 0.1
    SoftBodySettings cloth;
    double voxel = 0.02;  ///< cell size of Bullet's distance fields (m), 1e-3 to 0.25; Bullet's
                          ///< 0.25 lets cloth pass through small hulls
    double hull_margin = 0.0;  ///< how far hulls are blown up (m), 0 to 0.05
    int segments = 70;  ///< hulls made of a mesh obstacle that comes without segments, 1 to 1000

    /// "bullet": 1/60 s and 10 iterations, what people ship; with another number of iterations
    /// "bullet-K". Margin 10 mm: with 4 mm a T-shirt sinks 60 mm into the shoulders within a
    /// second.
    static BulletClothSettings shipped(int iterations = 10);
    /// "bullet-fine": 1/240 s and 5 iterations, what holds; margin 4 mm.
    static BulletClothSettings fine();
};

/// Bullet's own soft body solver in a world of its own, as a competent Bullet user sets it up for
/// an animated character: one convex hull per body segment, moved rigidly with it.
///
///     BulletClothStepper stepper(garment, BulletClothSettings::shipped(),
///                                segment_body(body.rest_mesh(), body.dominant_joint()));
///
/// A segment's motion is the rigid motion that fits its vertices of the mesh obstacle best at t and
/// at t + dt. The segments belong to the first mesh obstacle that has their vertices; other meshes
/// are cut into hulls at first sight. Primitives are Bullet's primitives, a plane is a large box.
///
/// Bullet's velocity at the end of the last sub-step is not (x_t - x_{t-1}) / dt: a state that is
/// given back as it was returned goes on with Bullet's, any other state with its own. Numbers are
/// floats; the material is Bullet's (SoftBodySettings), the fabric only gives the masses;
/// max_penetration is the depth below the hulls, which are no exact copy of the obstacle.
class BulletClothStepper : public Stepper {
 public:
    /// Keeps a reference to `garment`.
    /// @throws ArgumentError if a setting is out of range
    explicit BulletClothStepper(const Garment& garment, BulletClothSettings settings = {},
                                std::vector<BodySegment> segments = {});
    ~BulletClothStepper() override;

    std::string name() const override { return m_settings.name; }
    StepReport step(const Boundary& boundary, double dt, ClothState& state) override;

 private:
    class World;

    void run(const Boundary& boundary, double dt, ClothState& state, StepReport& report);

    const Garment& m_garment;
    BulletClothSettings m_settings;
    std::vector<BodySegment> m_segments;
    std::unique_ptr<World> m_world;  ///< made anew after a step that failed
};

}  // namespace cloth
