#include "gnn/train/scene_pool.h"

#include <sstream>

#include "gnn/train/archive_tensors.h"

namespace cloth {

void ScenePoolState::write(torch::serialize::OutputArchive& archive,
                           const std::string& prefix) const {
    archive.write(prefix + "random", c10::IValue(random));
    for (size_t slot = 0; slot < scenes.size(); ++slot) {
        const std::string key = prefix + "scene" + std::to_string(slot);
        const Scene& scene = scenes[slot];
        archive.write(key + ".seed", torch::tensor(static_cast<std::int64_t>(scene.seed)));
        archive.write(key + ".age", torch::tensor(static_cast<std::int64_t>(scene.age)));
        archive.write(key + ".time", torch::tensor(scene.state.time, torch::kFloat64));
        archive.write(key + ".x", to_tensor(scene.state.x));
        archive.write(key + ".v", to_tensor(scene.state.v));
    }
}

void ScenePoolState::read(torch::serialize::InputArchive& archive, const std::string& prefix,
                          int size) {
    c10::IValue text;
    archive.read(prefix + "random", text);
    random = text.toStringRef();
    scenes.resize(static_cast<size_t>(size));
    for (size_t slot = 0; slot < scenes.size(); ++slot) {
        const std::string key = prefix + "scene" + std::to_string(slot);
        Scene& scene = scenes[slot];
        scene.seed =
            static_cast<std::uint64_t>(read_tensor(archive, key + ".seed").item<std::int64_t>());
        scene.age = static_cast<int>(read_tensor(archive, key + ".age").item<std::int64_t>());
        scene.state.time = read_tensor(archive, key + ".time").item<double>();
        scene.state.x = to_points(read_tensor(archive, key + ".x"));
        scene.state.v = to_points(read_tensor(archive, key + ".v"));
    }
}

ScenePool::ScenePool(const SceneFactory& factory, int size, std::uint64_t seed)
    : m_factory(factory), m_size(size), m_random(seed) {
}

std::unique_ptr<TrainingScene> ScenePool::make(const Recipe& recipe, double progress) {
    auto scene = m_factory.make(m_random.bits());
    scene->warm_up(recipe.heal_iterations, recipe.contact_weight(progress));
    return scene;
}

void ScenePool::fill(const Recipe& recipe, const std::atomic<bool>& stop,
                     const std::function<void(const TrainingScene&)>& made) {
    m_scenes.clear();
    for (int slot = 0; slot < m_size; ++slot) {
        if (stop) return m_scenes.clear();
        auto scene = make(recipe, 0.0);
        // Ages are spread out, or all scenes would be replaced at the same time.
        scene->age = m_random.below(scene->parts().life / 2 + 1);
        scene->prepare(recipe.contact_weight(0.0));
        made(*scene);
        m_scenes.push_back(std::move(scene));
    }
}

TrainingScene& ScenePool::draw() {
    m_slot = static_cast<size_t>(m_random.below(m_size));
    return drawn();
}

void ScenePool::replace_drawn(const Recipe& recipe, double progress) {
    m_scenes[m_slot] = make(recipe, progress);
}

ScenePoolState ScenePool::state() const {
    ScenePoolState all;
    std::ostringstream random;
    random << m_random.engine();
    all.random = random.str();
    for (const auto& scene : m_scenes)
        all.scenes.push_back({scene->parts().seed, scene->age, scene->state});
    return all;
}

void ScenePool::set_state(const ScenePoolState& state) {
    std::istringstream(state.random) >> m_random.engine();
    m_scenes.clear();
    for (const ScenePoolState::Scene& kept : state.scenes) {
        auto scene = m_factory.make(kept.seed);
        scene->age = kept.age;
        scene->state = kept.state;
        m_scenes.push_back(std::move(scene));
    }
}

}  // namespace cloth
