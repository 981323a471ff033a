#include "demos/hard_cases/motion_cases.h"

#include <cmath>
#include <filesystem>
#include <memory>

#include "data/body/motion.h"
#include "data/core/errors.h"
#include "demos/compare/body_scene.h"
#include "demos/compare/input_files.h"
#include "demos/hard_cases/case_scenes.h"

namespace cloth {
namespace {

std::shared_ptr<const BodyScene> whole_motion(const std::string& motion, const std::string& garment,
                                              bool limbs = true) {
    BodySceneSettings settings;
    settings.limbs = limbs;
    settings.motion = motion;
    settings.garment = garment;
    settings.frames = 0;
    return std::make_shared<const BodyScene>(settings);
}

/// @param scene_time  of the scene's clock (s), at a time of the case's
HardSceneParts parts_of(const std::shared_ptr<const BodyScene>& scene,
                        const std::function<double(double)>& scene_time) {
    HardSceneParts parts{scene->garment(), scene->start(),
                         [scene, scene_time](double t0, double t1) {
                             return scene->boundary(scene_time(t0), scene_time(t1));
                         }};
    parts.segments = scene->segments();
    parts.self_contact = scene->self_contact();
    parts.limbs = scene->has_limbs();
    parts.loss = [scene](const Boundary& boundary, const Points& x) {
        return scene->loss(boundary, x);
    };
    return parts;
}

double lead_in(const BodyScene& scene) {
    return scene.lead_in_frames() * scene.frame_time();
}

}  // namespace

HardCase motion_case(const std::string& motion, const std::string& garment, bool limbs) {
    const std::shared_ptr<const BodyScene> scene = whole_motion(motion, garment, limbs);
    HardCase hard;
    hard.name = "motion-" + std::filesystem::path(motion).stem().string();
    if (!limbs) hard.name += "-no-limbs";
    hard.sentence = garment + " on a body in the motion " + motion;
    hard.frames = scene->lead_in_frames() + scene->frames();
    hard.bounds.reason = "1.1 times the reference";
    hard.stretch_of_reference = 1.1;
    hard.inputs = garment;
    const std::string files = files_key(scene_files(garment, motion));
    if (!files.empty()) hard.inputs += "; " + files;
    hard.parts = [scene] {
        const double before = lead_in(*scene);
        return parts_of(scene, [=](double t) { return t - before; });
    };
    return hard;
}

/// The motion to and fro for ever.
HardSceneParts soak_motion() {
    const std::shared_ptr<const BodyScene> scene = whole_motion("01_01", "tshirt_1000");
    const double before = lead_in(*scene);
    const double length = scene->frames() * scene->frame_time();
    // it slows down to turn round, as a pendulum does
    return parts_of(scene, [=](double t) {
        if (t < before) return t - before;
        return 0.5 * length * (1.0 - std::cos(M_PI * (t - before) / length));
    });
}

std::vector<std::string> with_folders_listed(const std::vector<std::string>& motions) {
    std::vector<std::string> names;
    for (const std::string& motion : motions) {
        if (!std::filesystem::is_directory(motion)) {
            names.push_back(motion);
            continue;
        }
        const std::vector<std::string> files = list_motions(motion);
        if (files.empty())
            throw LoadError(motion, "", "holds no BVH file", "name a folder of BVH files");
        names.insert(names.end(), files.begin(), files.end());
    }
    return names;
}

}  // namespace cloth
