#pragma once

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "tests/data/files/npz_writer.h"

namespace cloth::test {

/// A column of four rings of four vertices, at heights 0 to 3, with three joints: at heights 0, 1
/// and 2. In the formats of SMPL's files; two shapes, and pose shapes.
inline std::map<std::string, std::string> small_smpl_model() {
    std::vector<float> vertices, weights, shapes, bends;
    std::vector<double> regressor(3 * 16, 0.0);
    std::vector<std::uint32_t> faces;
    for (std::uint32_t ring = 0; ring < 4; ++ring)
        for (std::uint32_t k = 0; k < 4; ++k) {
            const float angle = 1.5707963f * static_cast<float>(k);
            vertices.insert(vertices.end(), {0.3f * std::cos(angle), static_cast<float>(ring),
                                             0.3f * std::sin(angle)});
            const std::uint32_t joint = ring == 0 ? 0 : ring - 1;
            for (std::uint32_t j = 0; j < 3; ++j) weights.push_back(j == joint ? 1.0f : 0.0f);
            if (ring < 3) regressor[16 * ring + 4 * ring + k] = 0.25;
            if (ring == 3) continue;
            const std::uint32_t a = 4 * ring + k, b = 4 * ring + (k + 1) % 4;
            faces.insert(faces.end(), {a, a + 4, b, b, a + 4, b + 4});
        }
    for (int i = 0; i < 16; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            shapes.push_back(axis == 1 ? 0.1f * static_cast<float>(i / 4) : 0.0f);  // taller
            shapes.push_back(axis == 0 ? 0.05f : 0.0f);                             // aside
            for (int p = 0; p < 18; ++p) bends.push_back(p == 1 && axis == 2 ? 0.2f : 0.0f);
        }
    return {{"v_template", npy({16, 3}, vertices)},
            {"f", npy({24, 3}, faces)},
            {"weights", npy({16, 3}, weights)},
            {"kintree_table", npy({2, 3}, std::vector<std::uint32_t>{4294967295u, 0, 1, 0, 1, 2})},
            {"J_regressor", npy({3, 16}, regressor)},
            {"shapedirs", npy({16, 3, 2}, shapes)},
            {"posedirs", npy({16, 3, 18}, bends)}};
}

/// Three frames of three joints at 10 frames a second, upright in AMASS's world, where z is up.
inline std::map<std::string, std::string> small_amass_motion() {
    const double quarter = 1.5707963267948966;
    std::vector<double> poses(3 * 9, 0.0), places;
    for (int frame = 0; frame < 3; ++frame) {
        poses[static_cast<size_t>(9 * frame)] = quarter;                    // the root: upright
        poses[static_cast<size_t>(9 * frame + 5)] = 0.5 * quarter * frame;  // joint 1 about z
        places.insert(places.end(), {1.0, 2.0 + 0.1 * frame, 0.9});
    }
    return {{"poses", npy({3, 9}, poses)},
            {"trans", npy({3, 3}, places)},
            {"mocap_framerate", npy({}, std::vector<double>{10.0})},
            {"betas", npy({4}, std::vector<double>{1.0, 0.0, 3.0, 3.0})},
            {"gender", npy("<U4", {}, std::string("m\0\0\0a\0\0\0l\0\0\0e\0\0\0", 16))}};
}

}  // namespace cloth::test
