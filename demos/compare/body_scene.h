#pragma once

#include <memory>
#include <string>

#include "data/body/animated_body.h"
#include "data/body/outfit.h"
#include "demos/compare/comparison_scene.h"
#include "demos/compare/openings.h"

namespace cloth {

/// Which garment, on which motion, for how long.
struct BodySceneSettings {
    std::string garment = "tshirt";  ///< as load_outfit() takes it; layers have self-contact
    std::string fabric = "soft";     ///< see fabric_named()
    std::string body = "default";    ///< see body_named(); the garment is fitted to it
    std::string motion = "01_01";
    int rate = 30;              ///< frames per second
    int frames = 90;            ///< of the motion; 0: all
    int reference_frames = 30;  ///< frames with references; 0: all
    /// Cloth passes through limbs that pass through others. Not where steps are judged by their
    /// energy: that needs the same surface for all solvers.
    bool limbs = false;
};

/// A garment on a moving body. The clock starts with the motion; in the lead-in the body moves from
/// its rest pose into the motion's first pose and the garment settles.
class BodyScene : public ComparisonScene {
 public:
    /// @throws LoadError, ArgumentError, UsageError if the garment or the motion cannot be had
    explicit BodyScene(const BodySceneSettings& settings);

    const AnimatedBody& body() const { return *m_body; }
    const Outfit& outfit() const { return m_outfit; }

    /// Skin of the body at a time of the motion's clock (|V| x 3, m).
    Points skin(double time) const;

    Boundary boundary(double t0, double t1) const override;
    /// As worn on the body's rest pose.
    ClothState start() const override { return m_outfit.start; }
    int lead_in_frames() const override { return m_lead_in_frames; }
    std::vector<BodySegment> segments() const override;
    bool has_limbs() const override { return m_body->limbs() != nullptr; }
    /// "slid off the body": the garment's middle is 0.3 m from the middle of the skin that it
    /// covers at its start, however the body bends. "LeftFingerBase slipped out of an opening": see
    /// Openings.
    std::string loss(const Boundary& boundary, const Points& x) const override;

    SelfContactSettings self_contact() const override { return m_self_contact; }

 private:
    BodyScene(const BodySceneSettings& settings, std::shared_ptr<const Body> body);
    BodyScene(const BodySceneSettings& settings, std::shared_ptr<const Body> body,
              const Outfit& outfit);
    void find_covered_skin();
    bool is_near_covered(const Points& skin, const Points& x) const;
    Vec3 middle_of_covered(const Points& skin) const;

    std::unique_ptr<AnimatedBody> m_body;
    Outfit m_outfit;
    SelfContactSettings m_self_contact;
    int m_lead_in_frames = 0;
    std::vector<int> m_covered;  ///< vertices of the skin, as often as garment vertices are nearest
    Vec3 m_start_offset;         ///< from their middle to the garment's, at its start (m)
    Openings m_openings;
};

/// @throws UsageError naming the garments there are if a part of the outfit is none of them, and no
///         file
void check_garment_name(const std::string& name);

/// "soft": SNUG's cotton, 33 N/m; "real": cotton as measured, 5 kN/m.
/// @throws UsageError for another name
Fabric fabric_named(const std::string& name);

}  // namespace cloth
