#pragma once

#include <torch/serialize/archive.h>

#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "gnn/train/recipe.h"
#include "gnn/train/scene_random.h"
#include "gnn/train/training_worlds.h"

namespace cloth {

/// The state of a pool, for checkpoints.
struct ScenePoolState {
    struct Scene {
        std::uint64_t seed = 0;
        int age = 0;
        ClothState state;
    };
    std::string random;
    std::vector<Scene> scenes;
    std::uint64_t spare_seed = 0;
    double spare_contact_weight = 0.0;

    /// @param prefix  of the keys
    void write(torch::serialize::OutputArchive& archive, const std::string& prefix) const;
    /// @param size  scenes of the pool
    void read(torch::serialize::InputArchive& archive, const std::string& prefix, int size);
};

/// Scenes that are trained on in turn, and the random numbers that choose among them. The scene
/// that will replace the next one is made ahead.
class ScenePool {
 public:
    /// @param in_background  spare scenes are made by a thread of their own, not when they are
    ///                       needed; the same scenes
    ScenePool(const SceneFactory& factory, int size, std::uint64_t seed, bool in_background);

    bool empty() const { return m_scenes.empty(); }
    SceneRandom& random() { return m_random; }

    /// Makes all scenes and prepares their first steps, which may take minutes.
    /// Empty afterwards if `stop` is set meanwhile.
    /// @param made  is called after each scene
    void fill(const Recipe& recipe, const std::atomic<bool>& stop,
              const std::function<void()>& made);

    /// Draws the scene of the next iteration.
    TrainingScene& draw();
    const std::vector<std::unique_ptr<TrainingScene>>& scenes() const { return m_scenes; }
    TrainingScene& drawn() { return *m_scenes[m_slot]; }
    /// Puts a new scene into the place of the drawn one.
    void replace_drawn(const Recipe& recipe, double progress);

    ScenePoolState state() const;
    void set_state(const Recipe& recipe, const ScenePoolState& state);

 private:
    struct Spare {
        std::uint64_t seed = 0;
        double contact_weight = 0.0;
        std::future<std::unique_ptr<TrainingScene>> scene;
    };

    void order_spare(const Recipe& recipe, std::uint64_t seed, double contact_weight);

    const SceneFactory& m_factory;
    int m_size;
    bool m_in_background;
    SceneRandom m_random;
    Spare m_spare;
    std::vector<std::unique_ptr<TrainingScene>> m_scenes;
    size_t m_slot = 0;
};

}  // namespace cloth
