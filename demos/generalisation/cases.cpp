#include "demos/generalisation/cases.h"

namespace cloth {
namespace {

// What training uses, and what it leaves out (gnn/train/training_worlds.cpp).
const std::vector<std::string> kGarments = {"tshirt_1000", "pants_1000", "dress_1000"};
const std::vector<std::string> kNewGarments = {"tank_top_1000"};
const std::vector<std::string> kMotions = {"02_03", "05_20"};
const std::vector<std::string> kNewMotions = {"01_01", "16_35"};
// Shapes are drawn anew in training, by other numbers.
const std::vector<std::string> kNewBodies = {"1001", "1002"};

CaseGroup group(const std::string& name, int frames, const std::vector<std::string>& garments,
                const std::vector<std::string>& motions, const std::vector<std::string>& bodies) {
    CaseGroup cases{name, {}};
    for (const std::string& garment : garments)
        for (size_t k = 0; k < motions.size(); ++k) {
            SceneSettings scene;
            scene.name = garment;
            scene.frames = frames;
            scene.motion = motions[k];
            scene.body = bodies[k % bodies.size()];
            cases.scenes.push_back(scene);
        }
    return cases;
}

}  // namespace

std::vector<CaseGroup> generalisation_cases(int frames) {
    const std::vector<std::string> body = {"default"};
    return {group("trained", frames, kGarments, kMotions, body),
            group("motion", frames, kGarments, kNewMotions, body),
            group("body", frames, kGarments, kMotions, kNewBodies),
            group("garment", frames, kNewGarments, kMotions, body),
            group("all", frames, kNewGarments, kNewMotions, kNewBodies)};
}

}  // namespace cloth
