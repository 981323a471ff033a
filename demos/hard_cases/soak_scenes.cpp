// Scenes that may last for ever.

#include "demos/hard_cases/case_scenes.h"

namespace cloth {

namespace {
constexpr int soak_vertices = 300;
}

HardSceneParts soak_rest() {
    const Vec3 half(0.2, 0.1, 0.2);
    Garment garment("tablecloth", level_sheet(soak_vertices), Fabric::soft_cotton());
    const ClothState start = ClothState::at_rest(garment);
    const auto outside = [=](double, double) {
        Boundary boundary;
        boundary.pin_targets.resize(0, 3);
        const Vec3 centre(0.0, -half.y() - 0.01, 0.0);
        boundary.obstacles.push_back(box(half, centre, centre));
        return boundary;
    };
    HardSceneParts parts{std::move(garment), start, outside};
    parts.loss = [](const Boundary&, const Points& x) {
        return x.col(1).maxCoeff() < -0.05 ? "slid off the table" : "";
    };
    return parts;
}

HardSceneParts soak_loop() {
    return swing(level_sheet(soak_vertices), {});
}

}  // namespace cloth
