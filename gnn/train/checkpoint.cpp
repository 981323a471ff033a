#include <cstdio>
#include <sstream>

#include "data/core/errors.h"
#include "gnn/train/checkpoint_file.h"
#include "gnn/train/trainer.h"

namespace cloth {

using torch::Tensor;
using torch::serialize::InputArchive;
using torch::serialize::OutputArchive;

namespace {

Tensor to_tensor(const Points& points) {
    return torch::from_blob(const_cast<double*>(points.data()), {points.rows(), 3}, torch::kFloat64)
        .clone();
}

Points to_points(const Tensor& tensor) {
    return Eigen::Map<const Points>(tensor.contiguous().data_ptr<double>(), tensor.size(0), 3);
}

Tensor to_tensor(const Eigen::VectorXd& values) {
    return torch::from_blob(const_cast<double*>(values.data()), {values.size()}, torch::kFloat64)
        .clone();
}

Eigen::VectorXd to_vector(const Tensor& tensor) {
    return Eigen::Map<const Eigen::VectorXd>(tensor.data_ptr<double>(), tensor.numel());
}

std::string describe(const TrainerSettings& settings) {
    std::ostringstream text;
    text << settings.model.to_json() << ' ' << settings.recipe.describe() << " seed "
         << settings.seed << " pool " << settings.pool << " statistics "
         << settings.freeze_statistics << " garments " << settings.scenes.garment_share << ' '
         << settings.scenes.shape_share << ' ' << settings.scenes.fabric_share;
    for (const std::string& garment : settings.scenes.garments) text << ' ' << garment;
    for (const int size : settings.scenes.sheet_sizes) text << ' ' << size;
    if (!settings.start_weights.empty()) text << " from weights";
    return text.str();
}

Tensor read(InputArchive& archive, const std::string& key) {
    Tensor tensor;
    archive.read(key, tensor);
    return tensor;
}

}  // namespace

void Trainer::save() {
    OutputArchive archive;
    archive.write("settings", c10::IValue(describe(m_settings)));
    std::ostringstream random;
    random << m_random.engine();
    archive.write("random", c10::IValue(random.str()));
    archive.write("iteration", torch::tensor(m_iteration));
    archive.write("seconds", torch::tensor(m_seconds, torch::kFloat64));
    archive.write("parameters", m_network.parameters().flat().detach());
    m_adam.save(archive);
    archive.write("statistics.node", to_tensor(m_node.state()));
    archive.write("statistics.edge", to_tensor(m_edge.state()));
    archive.write("statistics.world", to_tensor(m_world.state()));
    archive.write("statistics.body", to_tensor(m_body.state()));
    for (size_t slot = 0; slot < m_pool.size(); ++slot) {
        const std::string key = "scene" + std::to_string(slot);
        const TrainingScene& scene = *m_pool[slot];
        archive.write(key + ".seed", torch::tensor(static_cast<std::int64_t>(scene.parts().seed)));
        archive.write(key + ".age", torch::tensor(static_cast<std::int64_t>(scene.age)));
        archive.write(key + ".time", torch::tensor(scene.state.time, torch::kFloat64));
        archive.write(key + ".x", to_tensor(scene.state.x));
        archive.write(key + ".v", to_tensor(scene.state.v));
    }
    save_checkpoint(archive, m_settings.out);
    weights().save(m_settings.out + "/weights.safetensors");
}

bool Trainer::resume() {
    return load_checkpoint(
        m_settings.out, m_device,
        [&](InputArchive& archive, const std::string& file) { load(archive, file); });
}

void Trainer::load(InputArchive& archive, const std::string& file) {
    check_checkpoint_settings(archive, file, describe(m_settings));
    c10::IValue random;
    archive.read("random", random);
    std::istringstream(random.toStringRef()) >> m_random.engine();
    m_iteration = read(archive, "iteration").item<std::int64_t>();
    m_seconds = read(archive, "seconds").item<double>();
    torch::NoGradGuard no_grad;
    m_network.parameters().flat().copy_(read(archive, "parameters"));
    m_adam.load(archive);
    m_node.set_state(to_vector(read(archive, "statistics.node").cpu()));
    m_edge.set_state(to_vector(read(archive, "statistics.edge").cpu()));
    m_world.set_state(to_vector(read(archive, "statistics.world").cpu()));
    m_body.set_state(to_vector(read(archive, "statistics.body").cpu()));
    if (m_settings.start_weights.empty())
        m_network.set_statistics(
            {m_node.statistics(), m_edge.statistics(), m_world.statistics(), m_body.statistics()});
    m_pool.clear();
    for (int slot = 0; slot < m_settings.pool; ++slot) {
        const std::string key = "scene" + std::to_string(slot);
        const auto seed = read(archive, key + ".seed").item<std::int64_t>();
        m_pool.push_back(m_factory.make(static_cast<std::uint64_t>(seed)));
        TrainingScene& scene = *m_pool.back();
        scene.age = static_cast<int>(read(archive, key + ".age").item<std::int64_t>());
        scene.state.time = read(archive, key + ".time").item<double>();
        scene.state.x = to_points(read(archive, key + ".x").cpu());
        scene.state.v = to_points(read(archive, key + ".v").cpu());
    }
}

}  // namespace cloth
