#include "demos/hard_cases/hard_scene.h"

#include <random>

namespace cloth {

constexpr double start_offset = 1e-7;  // m: nothing to the eye, all to a chaotic run

ClothState HardScene::start_from(int which) const {
    ClothState state = start();
    if (which == 0) return state;
    // the standard fixes the numbers of the engine, but not those of its distributions
    std::mt19937 random(static_cast<std::mt19937::result_type>(which));
    const auto offset = [&] {
        return start_offset * (2.0 * random() / static_cast<double>(std::mt19937::max()) - 1.0);
    };
    for (Eigen::Index i = 0; i < state.x.rows(); ++i) {
        const Vec3 by(offset(), offset(), offset());
        if (!garment().is_pinned()[static_cast<size_t>(i)]) state.x.row(i) += by;
    }
    return state;
}

}  // namespace cloth
