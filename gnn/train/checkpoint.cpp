#include <sstream>

#include "gnn/train/archive_tensors.h"
#include "gnn/train/checkpoint_file.h"
#include "gnn/train/trainer.h"

namespace cloth {

using torch::serialize::InputArchive;
using torch::serialize::OutputArchive;

namespace {

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

/// The first lane's keys have none, as in checkpoints of before there were more.
std::string key_prefix(int lane) {
    return lane == 0 ? "" : "lane" + std::to_string(lane) + ".";
}

}  // namespace

/// Scenes of all processes.
void Trainer::write_scenes(OutputArchive& archive) const {
    if (m_group.size() == 1) {
        for (const Lane& lane : m_lanes) lane.pool.state().write(archive, key_prefix(lane.number));
        return;
    }
    OutputArchive own;
    for (const Lane& lane : m_lanes) lane.pool.state().write(own, key_prefix(lane.number));
    std::ostringstream bytes;
    own.save_to(bytes);
    const std::vector<std::string> all = m_group.from_all(bytes.str());
    if (!m_group.is_first()) return;
    std::vector<InputArchive> parts(all.size());
    for (size_t rank = 0; rank < all.size(); ++rank) {
        std::istringstream stream(all[rank]);
        parts[rank].load_from(stream);
    }
    for (int lane = 0; lane < m_settings.batch; ++lane) {
        ScenePoolState state;
        state.read(parts[static_cast<size_t>(lane % m_group.size())], key_prefix(lane),
                   m_settings.pool);
        state.write(archive, key_prefix(lane));
    }
}

void Trainer::save() {
    OutputArchive archive;
    write_scenes(archive);
    if (!m_group.is_first()) return;
    archive.write("settings", c10::IValue(describe(m_settings)));
    archive.write("iteration", torch::tensor(m_iteration));
    archive.write("seconds", torch::tensor(m_seconds, torch::kFloat64));
    archive.write("parameters", m_network.parameters().flat().detach());
    if (m_mean.defined()) archive.write("mean", m_mean);
    m_adam.save(archive);
    m_statistics.write(archive);
    save_checkpoint(archive, m_settings.out);
    weights().save(m_settings.out + "/weights.safetensors");
}

bool Trainer::resume() {
    return load_checkpoint(
        m_settings.out, m_group, m_device,
        [&](InputArchive& archive, const std::string& file) { load(archive, file); });
}

void Trainer::load(InputArchive& archive, const std::string& file) {
    check_checkpoint_settings(archive, file, describe(m_settings));
    m_iteration = read_tensor(archive, "iteration").item<std::int64_t>();
    m_seconds = read_tensor(archive, "seconds").item<double>();
    torch::NoGradGuard no_grad;
    m_network.parameters().flat().copy_(read_tensor(archive, "parameters"));
    if (m_mean.defined()) m_mean.copy_(read_tensor(archive, "mean"));
    m_adam.load(archive);
    m_statistics.read(archive);
    m_own_statistics = m_statistics;
    if (!m_group.is_first()) m_own_statistics.clear();
    if (m_settings.start_weights.empty()) m_network.set_statistics(m_statistics.statistics());
    for (Lane& lane : m_lanes) {
        ScenePoolState state;
        state.read(archive, key_prefix(lane.number), m_settings.pool);
        lane.pool.set_state(m_settings.recipe, state);
    }
}

}  // namespace cloth
