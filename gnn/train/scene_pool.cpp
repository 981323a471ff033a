#include "gnn/train/scene_pool.h"

#include <omp.h>

#include <sstream>

#include "gnn/train/archive_tensors.h"

namespace cloth {

void ScenePoolState::write(torch::serialize::OutputArchive& archive,
                           const std::string& prefix) const {
    archive.write(prefix + "random", c10::IValue(random));
    archive.write(prefix + "spare.seed", torch::tensor(static_cast<std::int64_t>(spare_seed)));
    archive.write(prefix + "spare.contact_weight",
                  torch::tensor(spare_contact_weight, torch::kFloat64));
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
    spare_seed = static_cast<std::uint64_t>(
        read_tensor(archive, prefix + "spare.seed").item<std::int64_t>());
    spare_contact_weight = read_tensor(archive, prefix + "spare.contact_weight").item<double>();
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

ScenePool::ScenePool(const SceneFactory& factory, int size, std::uint64_t seed, bool in_background)
    : m_factory(factory), m_size(size), m_in_background(in_background), m_random(seed) {
}

static std::unique_ptr<TrainingScene> make_warm(const SceneFactory& factory, std::uint64_t seed,
                                                int iterations, double contact_weight) {
    auto scene = factory.make(seed);
    scene->warm_up(iterations, contact_weight);
    return scene;
}

void ScenePool::order_spare(const Recipe& recipe, std::uint64_t seed, double contact_weight) {
    m_spare.seed = seed;
    m_spare.contact_weight = contact_weight;
    const int iterations = recipe.heal_iterations;
    m_spare.scene = std::async(
        m_in_background ? std::launch::async : std::launch::deferred,
        [&factory = m_factory, seed, iterations, contact_weight, own_thread = m_in_background] {
            if (own_thread) omp_set_num_threads(1);
            return make_warm(factory, seed, iterations, contact_weight);
        });
}

void ScenePool::fill(const Recipe& recipe, const std::atomic<bool>& stop,
                     const std::function<void()>& made) {
    m_scenes.clear();
    for (int slot = 0; slot < m_size; ++slot) {
        if (stop) return m_scenes.clear();
        auto scene = make_warm(m_factory, m_random.bits(), recipe.heal_iterations,
                               recipe.contact_weight(0.0));
        // Ages are spread out, or all scenes would be replaced at the same time.
        scene->age = m_random.below(scene->parts().life / 2 + 1);
        scene->prepare(recipe.contact_weight(0.0));
        m_scenes.push_back(std::move(scene));
        made();
    }
    order_spare(recipe, m_random.bits(), recipe.contact_weight(0.0));
}

TrainingScene& ScenePool::draw() {
    m_slot = static_cast<size_t>(m_random.below(m_size));
    return drawn();
}

void ScenePool::replace_drawn(const Recipe& recipe, double progress) {
    m_scenes[m_slot] = m_spare.scene.get();
    order_spare(recipe, m_random.bits(), recipe.contact_weight(progress));
}

ScenePoolState ScenePool::state() const {
    ScenePoolState all;
    std::ostringstream random;
    random << m_random.engine();
    all.random = random.str();
    for (const auto& scene : m_scenes)
        all.scenes.push_back({scene->parts().seed, scene->age, scene->state});
    all.spare_seed = m_spare.seed;
    all.spare_contact_weight = m_spare.contact_weight;
    return all;
}

void ScenePool::set_state(const Recipe& recipe, const ScenePoolState& state) {
    std::istringstream(state.random) >> m_random.engine();
    m_scenes.clear();
    for (const ScenePoolState::Scene& kept : state.scenes) {
        auto scene = m_factory.make(kept.seed);
        scene->age = kept.age;
        scene->state = kept.state;
        m_scenes.push_back(std::move(scene));
    }
    order_spare(recipe, state.spare_seed, state.spare_contact_weight);
}

}  // namespace cloth
