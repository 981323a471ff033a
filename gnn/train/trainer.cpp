#include "gnn/train/trainer.h"

#include <cmath>
#include <cstdio>
#include <ctime>
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

static TrainerSettings checked(TrainerSettings settings) {
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
    check("pool", settings.pool, 1, 1000);
    check("report_every", settings.report_every, 1, 1e6);
    check("validate_every", settings.validate_every, 0.0, 1e4);
    check("validation_share", settings.validation_share, 0.0, 1.0);
    check("save_every", settings.save_every, 0.0, 1e4);
    check("freeze_statistics", static_cast<double>(settings.freeze_statistics), 0.0, 1e9);
    settings.recipe.check();
    settings.scenes.skinned = settings.recipe.skinned;
    settings.scenes.check();
    settings.validation.check();
    settings.rollouts.threads = settings.threads;
    settings.rollouts.check();
    if (settings.references.empty()) settings.references = settings.out + "/references";
    std::filesystem::create_directories(settings.out);
    torch::set_num_threads(settings.threads);
    at::globalContext().setFlushDenormal(true);
    return settings;
}

Trainer::Trainer(TrainerSettings settings)
    : m_settings(checked(std::move(settings))),
      m_device(m_settings.device),
      m_network(m_settings.model, m_device, m_settings.seed),
      m_adam(m_network.parameters().count(), m_device),
      m_random(m_settings.seed),
      m_factory(m_settings.model, m_settings.scenes, m_settings.seed),
      m_node(node_layout(m_settings.model.features.force_features)),
      m_edge(edge_layout()),
      m_world(world_layout()),
      m_body(body_layout()) {
    if (!m_settings.start_weights.empty())
        m_network.import_weights(Weights::load(m_settings.start_weights));
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

void Trainer::replace(size_t slot) {
    const double weight = m_settings.recipe.contact_weight(progress());
    m_pool[slot] = m_factory.make(m_random.bits());
    m_pool[slot]->warm_up(m_settings.recipe.heal_iterations, weight);
}

void Trainer::fill_pool(const std::atomic<bool>& stop) {
    m_pool.resize(static_cast<size_t>(m_settings.pool));
    for (size_t slot = 0; slot < m_pool.size(); ++slot) {
        if (stop) return m_pool.clear();
        replace(slot);
        // Ages are spread out, or all scenes would be replaced at the same time.
        m_pool[slot]->age = m_random.below(m_pool[slot]->parts().life / 2 + 1);
        m_pool[slot]->prepare(m_settings.recipe.contact_weight(0.0));
        observe(*m_pool[slot]);
        std::fprintf(stderr, "\rmaking scenes %zu/%zu", slot + 1, m_pool.size());
    }
    std::fprintf(stderr, "\n");
}

void Trainer::observe(const TrainingScene& scene) {
    if (!m_settings.start_weights.empty()) return;
    const Features& features = scene.features();
    m_node.add(features.node);
    m_edge.add(features.edge);
    m_world.add(features.world, &features.world_mask);
    m_body.add(features.body, &features.world_mask);
    m_network.set_statistics(
        {m_node.statistics(), m_edge.statistics(), m_world.statistics(), m_body.statistics()});
}

void Trainer::add_noise(ClothState& state) {
    const double sigma = m_settings.recipe.noise;
    if (sigma == 0.0) return;
    // x_t and x_{t-1} are disturbed independently, so the velocity changes with both.
    for (Eigen::Index i = 0; i < state.x.rows(); ++i)
        for (int k = 0; k < 3; ++k) {
            const double now = sigma * m_random.normal(), before = sigma * m_random.normal();
            state.x(i, k) += now;
            state.v(i, k) += (now - before) / m_settings.model.dt;
        }
}

bool Trainer::train_on(TrainingScene& scene, Points& prediction, Points& target) {
    const Recipe& recipe = m_settings.recipe;
    double start = cpu_seconds();
    m_network.parameters().gradient().zero_();
    const Tensor output = m_network.forward(scene.graph(), scene.features());
    prediction = to_positions(scene, output);
    if (!prediction.allFinite()) return false;
    const Features& features = scene.features();
    LossProblem problem{
        &scene.potential(), &scene.laplacian(),    &scene.boundary(), &features.base, &target,
        features.scale,     recipe.position_weight};
    m_sums.network_seconds += cpu_seconds() - start;
    start = cpu_seconds();
    const bool from_base =
        scene.potential().value(features.base) <= scene.potential().value(prediction);
    target = from_base ? features.base : prediction;
    scene.refine(target, recipe.target_iterations);
    Points judged = prediction;
    if (recipe.loss_iterations > 0) scene.refine(judged, recipe.loss_iterations);
    m_sums.solver_seconds += cpu_seconds() - start;
    evaluate_loss(recipe.loss, problem, judged, m_loss);
    if (!std::isfinite(m_loss.value) || !m_loss.gradient.allFinite()) return false;
    const MatrixF gradient = (features.scale * m_loss.gradient).cast<float>();
    const Tensor seed =
        torch::from_blob(const_cast<float*>(gradient.data()), {gradient.rows(), 3}, torch::kFloat32)
            .to(m_device);
    start = cpu_seconds();
    output.backward(seed);
    const bool stepped =
        m_adam.step(m_network.parameters().flat(), m_network.parameters().gradient(),
                    recipe.learning_rate(m_iteration, progress()), recipe.clip_norm);
    m_sums.network_seconds += cpu_seconds() - start;
    return stepped;
}

bool Trainer::move_on(TrainingScene& scene, const Points& prediction, const Points& target) {
    const Recipe& recipe = m_settings.recipe;
    if (m_random.chance(recipe.heal_share(progress()))) return scene.advance(target);
    if (m_random.chance(1.0 - recipe.own_refined)) return scene.advance(prediction);
    Points refined = prediction;  // what network and iterations reach in use
    scene.refine(refined, recipe.own_iterations);
    return scene.advance(refined);
}

void Trainer::kick_some(TrainingScene& scene) {
    const KickSettings& kicks = m_settings.recipe.kicks;
    if (kicks.share == 0.0 || !m_random.chance(kicks.share)) return;
    kick(scene.garment(), kicks, m_random, scene.state);
    ++m_sums.kicks;
}

double Trainer::iterate() {
    if (m_pool.empty()) fill_pool(std::atomic<bool>{false});
    const Recipe& recipe = m_settings.recipe;
    const size_t slot = static_cast<size_t>(m_random.below(m_settings.pool));
    TrainingScene& scene = *m_pool[slot];
    const double weight = recipe.contact_weight(progress());
    const ClothState kept = scene.state;
    const int kept_age = scene.age;
    bool sound = true;
    Points prediction, target;
    add_noise(scene.state);
    for (int k = 0; k < recipe.rollout(m_iteration) && sound; ++k) {
        if (k > 0) sound = scene.advance(prediction);
        if (!sound) break;
        const double start = cpu_seconds();
        scene.prepare(weight);
        m_sums.prepare_seconds += cpu_seconds() - start;
        if (m_iteration < m_settings.freeze_statistics) observe(scene);
        sound = train_on(scene, prediction, target);
    }
    if (recipe.noise > 0.0) {  // the scene itself goes on as the solver moves it, without noise
        scene.state = kept;
        scene.age = kept_age;
        scene.prepare(weight);
        target = scene.features().base;
        scene.refine(target, recipe.heal_iterations);
        sound = scene.advance(target);
    } else {
        sound = sound && move_on(scene, prediction, target);
    }
    if (sound) kick_some(scene);
    m_sums.loss += m_loss.value;
    m_sums.gaps.push_back(m_loss.gap);
    m_sums.errors.push_back(m_loss.error);
    ++m_sums.count;
    if (m_sums.count % 10 == 1 && prediction.allFinite())
        m_sums.add(scene.potential().terms(prediction));
    if (!sound || scene.age > scene.parts().life) {
        m_sums.resets += sound ? 0 : 1;
        replace(slot);
    }
    ++m_iteration;
    return m_loss.value;
}

}  // namespace cloth
