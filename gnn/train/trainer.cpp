#include "gnn/train/trainer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <utility>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "gnn/train/training_run.h"

namespace cloth {

using torch::Tensor;

/// Processor time of this process (s): unlike the clock on the wall it tells the cost of a stage on
/// a busy machine.
static double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

static TrainerSettings checked(TrainerSettings settings, const ProcessGroup& group) {
    if (settings.iterations <= 0 && settings.minutes <= 0.0)
        throw ArgumentError("training", "has no end", "give iterations or minutes");
    if (settings.device != "cpu" && settings.device != "cuda")
        throw ArgumentError("device '" + settings.device + "'", "is not known", "use cpu or cuda");
    if (settings.device == "cuda" && !torch::cuda::is_available())
        throw ArgumentError("device cuda", "is not available", "use cpu");
    const auto check = [](const std::string& field, double value, double low, double high) {
        check_range("TrainerSettings." + field, value, low, high);
    };
    check("iterations", static_cast<double>(settings.iterations), 0.0, 1e9);
    check("minutes", settings.minutes, 0.0, 1e6);
    check("threads", settings.threads, 1, 256);
    check("batch", settings.batch, 1, 4096);
    if (settings.batch % group.size() != 0)
        throw ArgumentError("batch of " + std::to_string(settings.batch),
                            "cannot be shared by " + std::to_string(group.size()) + " processes",
                            "use a multiple of their number");
    check("pool", settings.pool, 1, 1000);
    check("report_every", settings.report_every, 1, 1e6);
    check("validate_every", settings.validate_every, 0.0, 1e4);
    check("validation_share", settings.validation_share, 0.0, 1.0);
    check("save_every", settings.save_every, 0.0, 1e4);
    check("freeze_statistics", static_cast<double>(settings.freeze_statistics), 0.0, 1e9);
    settings.at_once |= settings.device != "cpu";
    settings.recipe.check();
    settings.scenes.skinned = settings.recipe.skinned;
    settings.scenes.check();
    settings.validation.check();
    settings.rollouts.threads = settings.threads;
    settings.rollouts.check();
    if (settings.validation_share > 0.0 && settings.model.width % 16 != 0)
        throw ArgumentError("--width " + std::to_string(settings.model.width),
                            "is no multiple of 16, as the engine takes that validates rollouts",
                            "use such a width, or validate nothing: --validation-share 0");
    if (settings.references.empty()) settings.references = settings.out + "/references";
    std::filesystem::create_directories(settings.out);
    torch::set_num_threads(1);
    at::globalContext().setFlushDenormal(true);
    return settings;
}

Trainer::Lane::Lane(int index, const SceneFactory& factory, const TrainerSettings& settings)
    : number(index),
      // 2^64 over the golden ratio: seeds of lanes are far from those of trainings
      pool(factory, settings.pool,
           settings.seed + 0x9E3779B97F4A7C15u * static_cast<std::uint64_t>(index),
           settings.threads > 1) {
}

Trainer::Trainer(TrainerSettings settings, ProcessGroup group)
    : m_settings(checked(std::move(settings), group)),
      m_group(std::move(group)),
      m_device(m_settings.device),
      m_network(m_settings.model, m_device, m_settings.seed),
      m_adam(m_network.parameters().count(), m_device),
      m_sum(torch::zeros({m_network.parameters().count() + 1}, m_device)),
      m_factory(m_settings.model, m_settings.scenes, m_settings.seed),
      m_own_statistics(m_settings.model),
      m_statistics(m_settings.model) {
    for (int k = m_group.rank(); k < m_settings.batch; k += m_group.size())
        m_lanes.emplace_back(k, m_factory, m_settings);
    if (m_group.is_first() && m_settings.validation_share > 0.0) look_up_validation();
    if (m_settings.recipe.mean_share > 0.0) m_mean = m_network.parameters().flat().detach().clone();
    m_network.set_threads(m_settings.threads);
}

Trainer::~Trainer() = default;

double Trainer::progress() const {
    if (m_settings.iterations > 0)
        return static_cast<double>(m_iteration) / static_cast<double>(m_settings.iterations);
    return m_seconds / (60.0 * m_settings.minutes);
}

bool Trainer::is_done() const {
    const bool counted = m_settings.iterations > 0 && m_iteration >= m_settings.iterations;
    const bool timed = m_settings.minutes > 0.0 && m_seconds >= 60.0 * m_settings.minutes;
    return counted || timed;
}

bool Trainer::is_filled() const {
    return std::none_of(m_lanes.begin(), m_lanes.end(),
                        [](const Lane& lane) { return lane.pool.empty(); });
}

void Trainer::fill_pools(const std::atomic<bool>& stop) {
    std::atomic<int> made{0};
    const auto tell = [&] {
        const int count = ++made;
        if (m_group.is_first())
            std::fprintf(stderr, "\rmaking scenes %d/%zu", count,
                         m_lanes.size() * static_cast<size_t>(m_settings.pool));
    };
    for_each_lane(&TrainingSums::prepare_seconds,
                  [&](Lane& lane) { lane.pool.fill(m_settings.recipe, stop, tell); });
    for (const Lane& lane : m_lanes)
        for (const auto& scene : lane.pool.scenes()) m_own_statistics.add(scene->features());
    if (m_group.is_first()) std::fprintf(stderr, "\n");
    share_statistics();
}

void Trainer::share_statistics() {
    if (!m_settings.start_weights.empty()) return;
    m_statistics = m_own_statistics;
    m_statistics.sum(m_group);
    m_network.set_statistics(m_statistics.statistics());
}

static void add_noise(ClothState& state, double sigma, double dt, SceneRandom& random) {
    if (sigma == 0.0) return;
    // x_t and x_{t-1} are disturbed independently, so the velocity changes with both.
    for (Eigen::Index i = 0; i < state.x.rows(); ++i)
        for (int k = 0; k < 3; ++k) {
            const double now = sigma * random.normal(), before = sigma * random.normal();
            state.x(i, k) += now;
            state.v(i, k) += (now - before) / dt;
        }
}

void Trainer::begin(Lane& lane) {
    lane.scene = &lane.pool.draw();
    lane.kept = lane.scene->state;
    lane.kept_age = lane.scene->age;
    lane.sound = true;
    add_noise(lane.scene->state, m_settings.recipe.noise, m_settings.model.dt, lane.pool.random());
}

/// Work on the scenes alone, by as many threads as there are; each scene's is done by one.
/// @param seconds  of processor that it takes
void Trainer::for_each_lane(double TrainingSums::*seconds, const std::function<void(Lane&)>& work) {
    const double start = cpu_seconds();
    std::exception_ptr failure;
    const int lanes = static_cast<int>(m_lanes.size());
    const int threads = std::min(m_settings.threads, lanes);
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads) if (threads > 1)
    for (int k = 0; k < lanes; ++k) {
        try {
            work(m_lanes[static_cast<size_t>(k)]);
        } catch (...) {
#pragma omp critical(trainer_failure)
            failure = std::current_exception();
        }
    }
    m_sums.*seconds += cpu_seconds() - start;
    if (failure) std::rethrow_exception(failure);
}

/// The target of the lane's prediction, and its loss. False: the loss is not finite.
bool Trainer::judge(Lane& lane) {
    const Recipe& recipe = m_settings.recipe;
    TrainingScene& scene = *lane.scene;
    if (!lane.prediction.allFinite()) return false;
    const Features& features = scene.features();
    const LossProblem problem{&scene.potential(),    &scene.laplacian(), &scene.boundary(),
                              &features.base,        &lane.target,       features.scale,
                              recipe.position_weight};
    const bool from_base =
        scene.potential().value(features.base) <= scene.potential().value(lane.prediction);
    lane.target = from_base ? features.base : lane.prediction;
    scene.refine(lane.target, recipe.target_iterations);
    Points judged = lane.prediction;
    if (recipe.loss_iterations > 0) scene.refine(judged, recipe.loss_iterations);
    evaluate_loss(recipe.loss, problem, judged, lane.loss);
    return std::isfinite(lane.loss.value) && lane.loss.gradient.allFinite();
}

/// The gradient of the lane's loss by the network's output; zero where it is not sound.
Tensor Trainer::seed_of(const Lane& lane) const {
    const Features& features = lane.scene->features();
    Tensor seed = torch::zeros({features.base.rows(), 3}, torch::kFloat32);
    if (lane.sound)
        Eigen::Map<MatrixF>(seed.data_ptr<float>(), features.base.rows(), 3) =
            (features.scale * lane.loss.gradient).cast<float>();
    return seed;
}

/// Leaves the gradient of the lane's loss in that of the parameters. False: it is not finite.
bool Trainer::differentiate(Lane& lane) {
    double start = cpu_seconds();
    m_network.parameters().gradient().zero_();
    const Tensor output = m_network.forward(lane.scene->graph(), lane.scene->features());
    lane.prediction = to_positions(*lane.scene, output);
    m_sums.network_seconds += cpu_seconds() - start;
    start = cpu_seconds();
    const bool finite = judge(lane);
    m_sums.solver_seconds += cpu_seconds() - start;
    if (!finite) return false;
    start = cpu_seconds();
    output.backward(seed_of(lane).to(m_device));
    const double norm = m_network.parameters().gradient().norm().item<double>();
    m_sums.network_seconds += cpu_seconds() - start;
    return std::isfinite(norm);
}

void Trainer::add_gradient(int lanes) {
    const Tensor& gradient = m_network.parameters().gradient();
    m_sum.narrow(0, 0, gradient.numel()).add_(gradient);
    m_sum.narrow(0, gradient.numel(), 1).add_(static_cast<double>(lanes));
}

/// The same for all lanes at once: their gradients' sum.
void Trainer::differentiate_at_once() {
    std::vector<const ClothGraph*> graphs;
    std::vector<const Features*> features;
    std::vector<Lane*> lanes;
    for (Lane& lane : m_lanes) {
        if (!lane.sound) continue;
        lanes.push_back(&lane);
        graphs.push_back(&lane.scene->graph());
        features.push_back(&lane.scene->features());
    }
    if (lanes.empty()) return;
    double start = cpu_seconds();
    m_network.parameters().gradient().zero_();
    const Tensor outputs = m_network.forward(graphs, features);
    const Tensor on_cpu = outputs.detach().to(torch::kCPU);
    std::int64_t row = 0;
    for (Lane* lane : lanes) {
        const std::int64_t rows = lane->scene->graph().vertex_count;
        lane->prediction = to_positions(*lane->scene, on_cpu.narrow(0, row, rows));
        row += rows;
    }
    m_sums.network_seconds += cpu_seconds() - start;
    for_each_lane(&TrainingSums::solver_seconds,
                  [this](Lane& lane) { lane.sound = lane.sound && judge(lane); });
    start = cpu_seconds();
    std::vector<Tensor> seeds;
    for (const Lane* lane : lanes) seeds.push_back(seed_of(*lane));
    outputs.backward(torch::cat(seeds).to(m_device));
    const auto sound =
        std::count_if(lanes.begin(), lanes.end(), [](const Lane* lane) { return lane->sound; });
    const bool finite = std::isfinite(m_network.parameters().gradient().norm().item<double>());
    if (finite) add_gradient(static_cast<int>(sound));  // else the iteration is lost
    m_sums.network_seconds += cpu_seconds() - start;
}

void Trainer::add_to_mean() {
    if (!m_mean.defined()) return;
    torch::NoGradGuard no_grad;
    const double span = m_settings.recipe.mean_share * static_cast<double>(m_iteration);
    m_mean.lerp_(m_network.parameters().flat(), 1.0 / std::max(1.0, span));
}

void Trainer::WithMean::swap() {
    if (!m_trainer.m_mean.defined()) return;
    torch::NoGradGuard no_grad;
    Tensor& flat = m_trainer.m_network.parameters().flat();
    const Tensor kept = flat.clone();
    flat.copy_(m_trainer.m_mean);
    m_trainer.m_mean.copy_(kept);
}

Weights Trainer::weights() {
    start();
    const WithMean mean(*this);
    return m_network.export_weights();
}

/// A step along the mean gradient of all sound lanes, of all processes.
void Trainer::step_together() {
    Parameters& parameters = m_network.parameters();
    m_sum.zero_();
    if (m_settings.at_once)
        differentiate_at_once();
    else
        for (Lane& lane : m_lanes) {
            if (lane.sound) lane.sound = differentiate(lane);
            if (lane.sound) add_gradient(1);
        }
    m_group.sum(m_sum);
    const double sound = m_sum[parameters.count()].item<double>();
    if (sound == 0.0) return;
    const double start = cpu_seconds();
    parameters.gradient().copy_(m_sum.narrow(0, 0, parameters.count())).div_(sound);
    m_adam.step(parameters.flat(), parameters.gradient(),
                m_settings.recipe.learning_rate(m_iteration, progress()),
                m_settings.recipe.clip_norm);
    add_to_mean();
    m_sums.network_seconds += cpu_seconds() - start;
}

bool Trainer::move_on(Lane& lane) {
    const Recipe& recipe = m_settings.recipe;
    SceneRandom& random = lane.pool.random();
    if (random.chance(recipe.heal_share(progress()))) return lane.scene->advance(lane.target);
    if (random.chance(1.0 - recipe.own_refined)) return lane.scene->advance(lane.prediction);
    Points refined = lane.prediction;  // what network and iterations reach in use
    lane.scene->refine(refined, recipe.own_iterations);
    return lane.scene->advance(refined);
}

bool Trainer::kick_some(Lane& lane) {
    const KickSettings& kicks = m_settings.recipe.kicks;
    if (kicks.share == 0.0 || !lane.pool.random().chance(kicks.share)) return false;
    kick(lane.scene->garment(), kicks, lane.pool.random(), lane.scene->state);
    return true;
}

void Trainer::end(Lane& lane) {
    const Recipe& recipe = m_settings.recipe;
    TrainingScene& scene = *lane.scene;
    const auto index = static_cast<int>(&lane - m_lanes.data());
    lane.has_terms = (m_sums.count + index) % 10 == 0 && lane.prediction.allFinite();
    if (lane.has_terms) lane.terms = scene.potential().terms(lane.prediction);
    if (recipe.noise > 0.0) {  // the scene itself goes on as the solver moves it, without noise
        scene.state = lane.kept;
        scene.age = lane.kept_age;
        scene.prepare(recipe.contact_weight(progress()));
        lane.target = scene.features().base;
        scene.refine(lane.target, recipe.heal_iterations);
        lane.sound = scene.advance(lane.target);
    } else {
        lane.sound = lane.sound && move_on(lane);
    }
    lane.kicked = lane.sound && kick_some(lane);
    if (!lane.sound || scene.age > scene.parts().life) lane.pool.replace_drawn(recipe, progress());
}

/// What the lane adds to the next row of metrics.csv.
void Trainer::count(const Lane& lane) {
    m_sums.loss += lane.loss.value;
    const Recipe& recipe = m_settings.recipe;
    if (recipe.loss == LossKind::both) m_sums.gaps.push_back(lane.loss.gap);
    if (recipe.position_weight > 0.0) m_sums.errors.push_back(lane.loss.error);
    ++m_sums.count;
    if (lane.has_terms) m_sums.add(lane.terms);
    m_sums.kicks += lane.kicked ? 1 : 0;
    m_sums.resets += lane.sound ? 0 : 1;
}

double Trainer::iterate() {
    start();
    if (!is_filled()) fill_pools(std::atomic<bool>{false});
    for (Lane& lane : m_lanes) begin(lane);
    const Recipe& recipe = m_settings.recipe;
    const int steps = recipe.rollout(m_iteration);
    for (int k = 0; k < steps; ++k) {
        for_each_lane(&TrainingSums::prepare_seconds, [&](Lane& lane) {
            if (k > 0 && lane.sound) lane.sound = lane.scene->advance(lane.prediction);
            if (lane.sound) lane.scene->prepare(recipe.contact_weight(progress()));
        });
        if (m_iteration < m_settings.freeze_statistics && m_settings.start_weights.empty()) {
            for (const Lane& lane : m_lanes)
                if (lane.sound) m_own_statistics.add(lane.scene->features());
            share_statistics();
        }
        step_together();
    }
    double loss = 0.0;
    for_each_lane(&TrainingSums::solver_seconds, [this](Lane& lane) { end(lane); });
    for (const Lane& lane : m_lanes) {
        count(lane);
        loss += lane.loss.value;
    }
    ++m_iteration;
    return loss / static_cast<double>(m_lanes.size());
}

}  // namespace cloth
