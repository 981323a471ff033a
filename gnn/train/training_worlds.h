#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gnn/model/model_config.h"
#include "gnn/train/skinned_start.h"
#include "gnn/train/training_scene.h"

namespace cloth {

/// All committed garments of up to 4,000 vertices but tank_top; tshirt comes last.
std::vector<std::string> training_garments();

/// Those of them that follow a proxy, see SceneSettings::proxies; tshirt comes last.
std::vector<std::string> proxied_garments();

/// Names or files of the motions that are trained on: those of the shared data folder, else two of
/// assimp-testmodels. Those that are kept for validation and reports are left out. Says on standard
/// error if CLOTH_SHARED_DATA names a folder without motions/train.
/// @throws LoadError if that folder has no motion to train on
std::vector<std::string> training_motions();

struct SceneSettings {
    double garment_share =
        0.65;                   ///< of the scenes, 0 to 1; 0: no garment, body or motion is loaded
    double shape_share = 0.5;   ///< of garment scenes with a sampled body shape, where available;
                                ///< 0 to 1
    double fabric_share = 0.6;  ///< of scenes with a sampled fabric; the others are soft cotton;
                                ///< 0 to 1
    std::vector<int> sheet_sizes = {300, 500, 800, 1200};  ///< vertices, 9 to 200,000 each
    /// As load_garment() takes them. tank_top is kept out, so that there is an unseen garment; the
    /// last one is validated on.
    std::vector<std::string> garments = training_garments();
    std::vector<std::string> motions;  ///< names or files; empty: all training clips there are
    int max_warm_up = 40;              ///< frames, 0 to 1000
    SkinnedStartSettings skinned;      ///< of garment scenes; these have no warm-up
    /// Each step starts where a coarser garment shows the other: the one of the wardrobe that has
    /// 1,000 vertices and the same cut. Scenes of garments that have none, and sheets, start at the
    /// guess.
    bool proxies = false;

    /// @throws ArgumentError if a value is out of its range
    void check() const;
};

/// Makes training scenes: sheets pinned in various ways among moving spheres, and garments
/// on bodies in motion. A scene depends on its seed (and the settings) alone.
class SceneFactory {
 public:
    /// Loads body, motions and garments, if there is a share of scenes with garments.
    /// @throws LoadError for one that cannot be loaded, ArgumentError if none is left of garments
    /// or
    ///         motions: hours must not be spent on sheets alone
    SceneFactory(const ModelConfig& config, SceneSettings settings, std::uint64_t seed);
    ~SceneFactory();

    std::unique_ptr<TrainingScene> make(std::uint64_t seed) const;

    /// A garment on a given clip with the default body and soft cotton, from the rest pose on. Null
    /// where there is no garment.
    /// @param garment  index into the settings' garments; the last one that loaded if out of range
    std::unique_ptr<TrainingScene> make_garment(std::uint64_t seed, const std::string& motion,
                                                size_t garment) const;
    std::unique_ptr<TrainingScene> make_sheet(std::uint64_t seed) const;

    /// A scene of other parts, for the factory's kind of network.
    std::unique_ptr<TrainingScene> finish(SceneParts parts, std::uint64_t seed = 0) const;

    bool has_garments() const;
    /// Those that loaded, in the order of make_garment()'s index.
    std::vector<std::string> garment_names() const;

 private:
    struct Assets;
    void load_assets();

    ModelConfig m_config;
    SceneSettings m_settings;
    std::unique_ptr<Assets> m_assets;
};

}  // namespace cloth
