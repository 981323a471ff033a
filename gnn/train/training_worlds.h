#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gnn/model/model_config.h"
#include "gnn/train/training_scene.h"

namespace cloth {

struct SceneSettings {
    double tshirt_share = 0.65;  ///< of the scenes, 0 to 1, where garments and body can be loaded
    double shape_share =
        0.5;  ///< of T-shirt scenes, 0 to 1, with a sampled body shape, where available
    double fabric_share =
        0.6;  ///< of scenes, 0 to 1, with a sampled fabric; the others are soft cotton
    std::vector<int> sheet_sizes = {300, 500, 800, 1200};  ///< vertices, 4 to 1e5 each
    std::vector<std::string> garments = {"garments/tshirt_1000.obj", "garments/tshirt_2000.obj",
                                         "garments/tshirt.obj"};  ///< in data/assets
    std::vector<std::string> motions;  ///< names or files; empty: all training clips there are
    int max_warm_up = 40;              ///< frames, 0 to 10000
};

/// Makes training scenes: sheets pinned in various ways among moving spheres, and T-shirts on
/// bodies in motion. A scene depends on its seed (and the settings) alone.
class SceneFactory {
 public:
    /// Loads what it can of body, motions and garments; says on standard error what is missing.
    /// @throws ArgumentError if a setting is out of range
    SceneFactory(const ModelConfig& config, SceneSettings settings, std::uint64_t seed);
    ~SceneFactory();

    std::unique_ptr<TrainingScene> make(std::uint64_t seed) const;

    /// A T-shirt scene on a given clip with the default body and soft cotton, from the rest pose
    /// on. Null where there is no T-shirt.
    /// @param garment  index into the settings' garments; the last one that loaded if out of range
    std::unique_ptr<TrainingScene> make_tshirt(std::uint64_t seed, const std::string& motion,
                                               size_t garment) const;
    std::unique_ptr<TrainingScene> make_sheet(std::uint64_t seed) const;

    bool has_tshirts() const;

 private:
    struct Assets;
    ModelConfig m_config;
    SceneSettings m_settings;
    std::unique_ptr<Assets> m_assets;
};

}  // namespace cloth
