#include "demos/hard_cases/hard_cases.h"

#include <cmath>
#include <utility>

#include "demos/compare/arguments.h"
#include "demos/hard_cases/case_scenes.h"
#include "demos/hard_cases/odd_meshes.h"

namespace cloth {
namespace {

/// Gravity and all else turned so that down is +x.
Pose sideways() {
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitZ()).toRotationMatrix();
    return pose;
}

/// The ends of the ranges that networks are trained on.
Fabric soft_end() {
    Fabric fabric;
    fabric.density = 0.70;
    fabric.mu = 7.48;
    fabric.lambda = 1.66;
    fabric.bending = 6.37e-8;
    return fabric;
}
Fabric stiff_end() {
    Fabric fabric;
    fabric.density = 0.0434;
    fabric.mu = 29.9;
    fabric.lambda = 43.9;
    fabric.bending = 1.314e-3;
    return fabric;
}

using Scene = std::function<HardSceneParts()>;

/// The swinging sheet with some of its settings changed.
Scene swinging(void (*change)(SwingSettings&)) {
    SwingSettings settings;
    change(settings);
    return [settings] { return swing(settings); };
}
Scene swinging(TriMesh (*mesh)()) {
    return [mesh] { return swing(mesh(), {}); };
}

/// Says a case field by field.
class Case {
 public:
    Case(const char* name, const char* sentence) {
        m_case.name = name;
        m_case.sentence = sentence;
    }

    Case& lasts(int frames) { return m_case.frames = frames, *this; }
    Case& scene(Scene parts) { return m_case.parts = std::move(parts), *this; }
    Case& stretch(double p99) { return bounds().stretch_p99 = p99, *this; }
    Case& end_stretch(double p99) { return bounds().end_stretch_p99 = p99, *this; }
    Case& inside_mm(double deepest) { return bounds().penetration_mm = deepest, *this; }
    Case& rest_jitter_mm(double rms) { return bounds().rest_jitter_mm = rms, *this; }
    Case& speed(double rms) { return bounds().rms_speed = rms, *this; }
    Case& least_top_speed(double rms) { return bounds().least_top_speed = rms, *this; }
    Case& tangles(int edges) { return bounds().tangles = edges, *this; }
    Case& because(const char* reason) { return bounds().reason = reason, *this; }

    operator HardCase() const { return m_case; }

 private:
    Bounds& bounds() { return m_case.bounds; }

    HardCase m_case;
};

}  // namespace

const std::vector<HardCase>& hard_cases() {
    // The bound of stretch is 1.1 times what the reference has in its worst frame unless the reason
    // says otherwise; that of speed, where the garment falls freely, three quarters of the
    // reference's highest.
    static const std::vector<HardCase> cases = {
        Case("body-spin", "a T-shirt on a body that speeds up to 720 degrees/s")
            .lasts(45)
            .scene(body_spin)
            .stretch(1.23)
            .because("reference 1.12"),
        Case("fast-cape",
             "a cape with skinned goals and self-contact on a character that turns and darts about "
             "three times as fast as people do")
            .lasts(120)
            .scene(fast_cape)
            .stretch(1.3)
            .tangles(40)
            .because("it pulls with twenty times its weight; where it is folded over in a step, "
                     "few of its 1,700 edges may stay tangled"),
        Case("clipping-armature", "a T-shirt on a body whose arms pass through its trunk and back")
            .lasts(120)
            .scene(clipping_armature)
            .stretch(1.5)
            .because("a sleeve that is squeezed between arm and trunk stretches"),
        Case("hands-through-shirt", "a thin capsule moves into a hanging sheet at 2 m/s and back")
            .lasts(45)
            .scene(hands_through_shirt)
            .stretch(1.5)
            .because(
                "the reference (1.11) lets the limb through; cloth that is pushed stretches more"),
        Case("fast-ball",
             "a ball flies into a hanging sheet at 10 m/s, 0.33 m per frame, and stops behind it")
            .lasts(45)
            .scene(fast_ball)
            .stretch(1.6)
            .because("reference 1.25: its one damped step stretches less than sub-steps do"),
        Case("teleport", "body and seam of a cape jump by 1 m within a frame")
            .lasts(60)
            .scene(teleport)
            .stretch(3.1)
            .end_stretch(1.2)
            .because("twice the reference (1.56): less damped steps stretch more for a moment; it "
                     "must recover"),
        Case("dress-12000", "a sheet of 12,000 vertices falls on a ball")
            .lasts(30)
            .scene(dress_12000)
            .stretch(1.26)
            .least_top_speed(1.5)
            .because("the reference would take hours; 60 quasi-Newton iterations have 1.15"),
        Case("armpit-pinch", "two capsules close on a sheet to a gap of 1 mm")
            .lasts(60)
            .scene(armpit_pinch)
            .stretch(1.14)
            .because("reference 1.03"),
        Case("crotch-pinch", "two capsules close on a sheet and sink 6 mm into each other")
            .lasts(60)
            .scene(crotch_pinch)
            .stretch(1.14)
            .inside_mm(4.0)
            .because("reference 1.03; between limbs that overlap by 6 mm, the best place is 3 mm "
                     "inside both"),
        Case("closing-boxes", "a sheet is pulled out between two boxes that have closed to 2 mm")
            .lasts(45)
            .scene(closing_boxes)
            .stretch(1.73)
            .because("reference 1.57: the boxes hold on to the sheet"),
        Case("yanked-corner", "the only pinned vertex is yanked by 2 m at 20 m/s")
            .lasts(45)
            .scene(yanked_corner)
            .stretch(4.2)
            .end_stretch(1.4)
            .because("twice the reference (2.09): less damped steps stretch more for a moment; it "
                     "must recover"),
        Case("stretch-3", "two sides are pulled to 3 times the rest width and let go")
            .lasts(60)
            .scene(stretch_3)
            .stretch(3.36)
            .end_stretch(1.15)
            .because("reference 3.05, 1.04 at the end; letting go must not blow it up"),
        Case("crumple", "two sides are pushed together to 5 % and pulled apart again")
            .lasts(60)
            .scene(crumple)
            .stretch(1.16)
            .end_stretch(1.15)
            .because("reference 1.05, 1.04 at the end"),
        Case("falls-on-edge", "a sheet falls on its edge and crumples, with self-contact")
            .lasts(60)
            .scene(falls_on_edge)
            .stretch(1.3)
            .end_stretch(1.1)
            .tangles(0)
            .because("no edge passes through a face, in any frame"),
        Case("two-layers", "a small sheet falls on one that drapes over a ball, with self-contact")
            .lasts(45)
            .scene(two_layers)
            .stretch(1.3)
            .end_stretch(1.1)
            .tangles(0)
            .because("no edge passes through a face, in any frame"),
        Case("step-1-10", "a sheet swings onto a moving ball in time steps of 1/10 s")
            .lasts(20)
            .scene(swinging([](SwingSettings& s) { s.dt = 0.1; }))
            .stretch(1.21)
            .because("reference 1.10"),
        Case("fabric-soft-end", "the same at 1/30 s, the heaviest and softest fabric of training")
            .lasts(45)
            .scene(swinging([](SwingSettings& s) { s.fabric = soft_end(); }))
            .stretch(1.68)
            .least_top_speed(1.2)
            .because("reference 1.52"),
        Case("fabric-stiff-end", "the lightest and stiffest fabric of training")
            .lasts(45)
            .scene(swinging([](SwingSettings& s) { s.fabric = stiff_end(); }))
            .stretch(1.12)
            .least_top_speed(1.2)
            .because("reference 1.02"),
        Case("fabric-outside", "cotton as measured, 5 kN/m: far stiffer than in training")
            .lasts(45)
            .scene(swinging([](SwingSettings& s) { s.fabric = Fabric::real_cotton(); }))
            .stretch(1.11)
            .least_top_speed(1.2)
            .because("reference 1.005"),
        Case("density-1-16-light", "a fabric of 0.04 kg/m^2")
            .lasts(45)
            .scene(swinging([](SwingSettings& s) { s.fabric.density = 0.04; }))
            .stretch(1.13)
            .least_top_speed(1.2)
            .because("reference 1.03"),
        Case("density-1-16-heavy", "the same fabric at 0.64 kg/m^2")
            .lasts(45)
            .scene(swinging([](SwingSettings& s) { s.fabric.density = 0.64; }))
            .stretch(1.40)
            .least_top_speed(1.2)
            .because("reference 1.27"),
        Case("mixed-triangles", "triangles of 1 mm beside triangles of 5 cm")
            .lasts(45)
            .scene(swinging(mixed_triangles))
            .stretch(1.14)
            .because("reference 1.04"),
        Case("needles", "triangles with an angle of 1 degree")
            .lasts(45)
            .scene(swinging(needle_sheet))
            .stretch(1.26)
            .because("reference 1.15"),
        Case("degrees-3-20", "vertices of degree 3, 12 and 20")
            .lasts(45)
            .scene(swinging(uneven_degrees))
            .stretch(1.15)
            .because("reference 1.04"),
        Case("gravity-zero", "no gravity; the ball rises into the sheet and moves on")
            .lasts(45)
            .scene(swinging([](SwingSettings& s) {
                s.gravity = 0.0;
                s.ball_rise = 0.3;
            }))
            .stretch(1.15)
            .because("reference 1.05"),
        Case("gravity-sideways", "gravity along +x, the scene turned with it")
            .lasts(45)
            .scene(swinging([](SwingSettings& s) { s.place = sideways(); }))
            .stretch(1.23)
            .least_top_speed(1.2)
            .because("reference 1.12"),
        Case("gravity-tenfold", "98.1 m/s^2")
            .lasts(45)
            .scene(swinging([](SwingSettings& s) { s.gravity = 98.1; }))
            .stretch(1.63)
            .least_top_speed(3.5)
            .because("reference 1.48"),
        Case("far-away", "1 km from the origin")
            .lasts(45)
            .scene(swinging([](SwingSettings& s) { s.place = placed(Vec3(1000.0, 0.0, 0.0)); }))
            .stretch(1.23)
            .least_top_speed(1.2)
            .because("reference 1.12, as at the origin"),
        Case("soak-rest", "a tablecloth comes to rest and stays there")
            .lasts(300)
            .scene(soak_rest)
            .stretch(1.13)
            .rest_jitter_mm(0.05)
            .because("reference 1.03; it comes to rest: 0.013 mm per frame"),
        Case("soak-loop", "a hanging sheet is pushed by a ball to and fro for ever")
            .lasts(300)
            .scene(soak_loop)
            .stretch(1.22)
            .speed(3.0)
            .because(
                "reference 1.11 and 1.6 m/s in the first swing: a swing of 0.6 m brings no more"),
        Case("soak-motion", "a T-shirt on a body that jumps to and fro for ever")
            .lasts(300)
            .scene(soak_motion)
            .stretch(1.3)
            .because("reference 1.18")};
    return cases;
}

const HardCase& hard_case(const std::string& name) {
    std::vector<std::string> names;
    for (const HardCase& one : hard_cases()) {
        if (one.name == name) return one;
        names.push_back(one.name);
    }
    throw UsageError("case " + name + ": is unknown; choose " + join_list(names, ", "));
}

}  // namespace cloth
