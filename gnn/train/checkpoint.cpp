#include <array>
#include <sstream>
#include <utility>

#include "gnn/train/archive_tensors.h"
#include "gnn/train/checkpoint_file.h"
#include "gnn/train/setting_differences.h"
#include "gnn/train/trainer.h"

namespace cloth {

using torch::Tensor;
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

/// What describe() says, and the options that set it.
const std::vector<SettingLabel>& labels() {
    static const std::vector<SettingLabel> labels = {
        {"recipe", {"--recipe"}},
        {"loss", {"--loss"}},
        {"position", {"--position-weight"}},
        {"target", {"--target-iterations"}},
        {"loss after", {"--loss-iterations"}},
        {"rate", {"--learning-rate", "cosine decay"}},
        {"clip", {"limit of the gradient's norm"}},
        {"heal", {"--healed-first", "--healed-last", "--heal"}},
        {"own", {"--own-refined", "--own-iterations"}},
        {"kicks", {"--kicks", "sizes of kicks"}},
        {"skinned", {"--skinned", "--skinned-at-rest", "--skinned-noise"}},
        {"noise", {"--noise"}},
        {"rollout", {"--rollout", "iterations for each step more"}},
        {"contact", {"first contact weight", "last contact weight"}},
        {"mean", {"--mean-share"}, true},
        {"seed", {"--seed"}},
        {"pool", {"--pool"}},
        {"statistics", {"iterations that shape the statistics"}},
        {"garments",
         {"--garment-share", "share of body shapes", "share of fabrics",
          "--garment, and sizes of sheets:"}},
        {"from weights", {"--weights"}, true}};
    return labels;
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

static Tensor torch_vector(const VectorF& values) {
    return torch::from_blob(const_cast<float*>(values.data()), {values.size()}, torch::kFloat32)
        .clone();
}

static VectorF float_vector(const Tensor& tensor) {
    const Tensor own = tensor.cpu().contiguous();
    return Eigen::Map<const VectorF>(own.data_ptr<float>(), own.numel());
}

/// @tparam Statistics  NetworkStatistics, constant or not
template <typename Statistics>
static auto parts_of(Statistics& statistics) {
    using Part = std::pair<std::string, decltype(&statistics.node)>;
    return std::array<Part, 4>{Part{"node", &statistics.node}, Part{"edge", &statistics.edge},
                               Part{"world", &statistics.world}, Part{"body", &statistics.body}};
}

/// Normalisation of the features that came with the weights a training started from.
static void write_statistics(const NetworkStatistics& statistics, OutputArchive& archive) {
    for (const auto& [name, part] : parts_of(statistics)) {
        archive.write("used." + name + ".mean", torch_vector(part->mean));
        archive.write("used." + name + ".deviation", torch_vector(part->deviation));
    }
}

/// False: the checkpoint is of a program that did not keep them.
static bool read_statistics(InputArchive& archive, NetworkStatistics& statistics) {
    for (const auto& [name, part] : parts_of(statistics)) {
        Tensor mean, deviation;
        if (!archive.try_read("used." + name + ".mean", mean)) return false;
        archive.read("used." + name + ".deviation", deviation);
        part->mean = float_vector(mean);
        part->deviation = float_vector(deviation);
    }
    return true;
}

void Trainer::save() {
    start();
    OutputArchive archive;
    write_scenes(archive);
    if (!m_group.is_first()) return;
    archive.write("settings", c10::IValue(describe(m_settings)));
    archive.write("proxies", torch::tensor(m_settings.scenes.proxies));
    archive.write("iteration", torch::tensor(m_iteration));
    archive.write("seconds", torch::tensor(m_seconds, torch::kFloat64));
    archive.write("parameters", m_network.parameters().flat().detach());
    if (m_mean.defined()) archive.write("mean", m_mean);
    m_adam.save(archive);
    m_statistics.write(archive);
    if (!m_settings.start_weights.empty()) write_statistics(m_network.statistics(), archive);
    save_checkpoint(archive, m_settings.out);
    weights().save(m_settings.out + "/weights.safetensors");
}

bool Trainer::resume() {
    const bool resumed = load_checkpoint(
        m_settings.out, m_group, m_device,
        [&](InputArchive& archive, const std::string& file) { load(archive, file); });
    m_started = m_started || resumed;
    return resumed;
}

/// The number of scenes and --proxies do not stand in the text of the settings, which older
/// checkpoints have without them.
void Trainer::check_settings(InputArchive& archive, const std::string& file) const {
    check_checkpoint_settings(archive, file, describe(m_settings), labels());
    std::vector<SettingDifference> others;
    int lanes = 0;
    for (c10::IValue random; archive.try_read(key_prefix(lanes) + "random", random);) ++lanes;
    if (lanes != m_settings.batch)
        others.push_back({"--batch", std::to_string(lanes), std::to_string(m_settings.batch)});
    Tensor proxies;
    if (archive.try_read("proxies", proxies) && proxies.item<bool>() != m_settings.scenes.proxies)
        others.push_back({"--proxies", proxies.item<bool>() ? "given" : "none",
                          m_settings.scenes.proxies ? "given" : "none"});
    refuse_differences(file, others);
}

void Trainer::load(InputArchive& archive, const std::string& file) {
    check_settings(archive, file);
    NetworkStatistics statistics = m_network.statistics();
    const bool has_statistics = read_statistics(archive, statistics);
    if (has_statistics)
        m_network.set_statistics(statistics);
    else
        start();  // an older checkpoint: those of the weights' file
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
