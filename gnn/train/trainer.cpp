#include "gnn/train/trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>

#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

using torch::Tensor;
using Clock = std::chrono::steady_clock;

static double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Processor time of this process (s): unlike the clock on the wall it tells the cost of a stage on
/// a busy machine.
static double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// What a row of metrics.csv averages.
struct Trainer::Sums {
    EnergyTerms terms;
    double loss = 0.0;
    std::vector<double> gaps;
    double prepare_seconds = 0.0, network_seconds = 0.0, solver_seconds = 0.0;
    int count = 0, terms_count = 0, resets = 0;
    std::int64_t first_iteration = 0;
    double first_second = 0.0;
};

static void check(const TrainerSettings& s) {
    constexpr double many = 1e12;
    check_range("TrainerSettings.threads", s.threads, 0, 1024);
    check_range("TrainerSettings.iterations", static_cast<double>(s.iterations), 0.0, many);
    check_range("TrainerSettings.minutes", s.minutes, 0.0, 1e6);
    check_range("TrainerSettings.pool", s.pool, 1, 1000);
    check_range("TrainerSettings.report_every", s.report_every, 1, 1e9);
    check_range("TrainerSettings.validate_every", s.validate_every, 1, 1e9);
    check_range("TrainerSettings.save_every", s.save_every, 0.0, 1e6);
    check_range("TrainerSettings.freeze_statistics", static_cast<double>(s.freeze_statistics), 0.0,
                many);
    s.model.check();
    s.recipe.check();
}

static TrainerSettings checked(TrainerSettings settings) {
    check(settings);
    if (settings.iterations <= 0 && settings.minutes <= 0.0)
        throw ArgumentError("training", "has no end", "give iterations or minutes");
    if (settings.device != "cpu" && settings.device != "cuda")
        throw ArgumentError("device '" + settings.device + "'", "is not known", "use cpu or cuda");
    if (settings.device == "cuda" && !torch::cuda::is_available())
        throw ArgumentError("device cuda", "is not available", "use cpu");
    std::filesystem::create_directories(settings.out);
    torch::set_num_threads(std::max(1, settings.threads));
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
      m_body(body_layout()),
      m_sums(std::make_unique<Sums>()) {
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

void Trainer::fill_pool() {
    m_pool.resize(static_cast<size_t>(m_settings.pool));
    for (size_t slot = 0; slot < m_pool.size(); ++slot) {
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
        &scene.potential(), &scene.laplacian(), &scene.boundary(), &features.base, &target,
        features.scale};
    m_sums->network_seconds += cpu_seconds() - start;
    start = cpu_seconds();
    const bool from_base =
        scene.potential().value(features.base) <= scene.potential().value(prediction);
    target = from_base ? features.base : prediction;
    scene.refine(target, recipe.heal_iterations);
    m_sums->solver_seconds += cpu_seconds() - start;
    evaluate_loss(recipe.loss, problem, prediction, m_loss);
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
    m_sums->network_seconds += cpu_seconds() - start;
    return stepped;
}

bool Trainer::move_on(TrainingScene& scene, const Points& prediction, const Points& target) {
    if (m_random.chance(m_settings.recipe.heal_share(progress()))) return scene.advance(target);
    if (m_random.chance(0.5)) return scene.advance(prediction);
    Points refined = prediction;  // what network and two iterations reach in use
    scene.refine(refined, 2);
    return scene.advance(refined);
}

double Trainer::iterate() {
    if (m_pool.empty()) fill_pool();
    const Recipe& recipe = m_settings.recipe;
    const size_t slot = static_cast<size_t>(m_random.below(m_settings.pool));
    TrainingScene& scene = *m_pool[slot];
    const double weight = recipe.contact_weight(progress());
    const bool rolls = recipe.max_rollout > 1 || recipe.noise > 0.0;
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
        m_sums->prepare_seconds += cpu_seconds() - start;
        if (m_iteration < m_settings.freeze_statistics) observe(scene);
        sound = train_on(scene, prediction, target);
    }
    if (rolls) {  // the scene itself goes on as the solver moves it, without noise
        scene.state = kept;
        scene.age = kept_age;
        scene.prepare(weight);
        target = scene.features().base;
        scene.refine(target, recipe.heal_iterations);
        sound = scene.advance(target);
    } else {
        sound = sound && move_on(scene, prediction, target);
    }
    m_sums->loss += m_loss.value;
    m_sums->gaps.push_back(m_loss.gap);
    ++m_sums->count;
    if (m_sums->count % 10 == 1 && prediction.allFinite()) {
        const EnergyTerms terms = scene.potential().terms(prediction);
        m_sums->terms.strain += terms.strain;
        m_sums->terms.bending += terms.bending;
        m_sums->terms.gravity += terms.gravity;
        m_sums->terms.inertia += terms.inertia;
        m_sums->terms.contact += terms.contact;
        m_sums->terms.friction += terms.friction;
        ++m_sums->terms_count;
    }
    if (!sound || scene.age > scene.parts().life) {
        m_sums->resets += sound ? 0 : 1;
        replace(slot);
    }
    ++m_iteration;
    return m_loss.value;
}

void Trainer::run(const std::atomic<bool>& stop) {
    m_validation = std::make_unique<Validation>(m_factory, m_settings.validation);
    for (int k : {1, 3}) {
        const ValidationResult solver = m_validation->measure_solver(k);
        std::fprintf(stderr, "solver, %d iterations: gap T-shirt %.3f, sheet %.3f\n", k,
                     solver.tshirt.median, solver.sheet.median);
    }
    if (m_pool.empty()) fill_pool();
    const double before = m_seconds;
    double saved = m_seconds;
    const Clock::time_point start = Clock::now();
    m_sums = std::make_unique<Sums>();
    m_sums->first_iteration = m_iteration;
    m_sums->first_second = m_seconds;
    while (!stop && !is_done()) {
        iterate();
        m_seconds = before + seconds_since(start);
        if (m_iteration % m_settings.report_every == 0) report(false);
        if (m_seconds - saved > 60.0 * m_settings.save_every) {
            save();
            saved = m_seconds;
        }
    }
    report(true);
    save();
}

void Trainer::report(bool last) {
    if (m_sums->count == 0) return;
    const bool validates = last || m_iteration % m_settings.validate_every == 0;
    ValidationResult validation;
    if (validates) validation = m_validation->measure(m_network);
    write_row(validates ? &validation : nullptr);
    m_sums = std::make_unique<Sums>();
    m_sums->first_iteration = m_iteration;
    m_sums->first_second = m_seconds;
}

static double median(std::vector<double> values) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
}

void Trainer::write_row(const ValidationResult* validation) {
    const std::string file = m_settings.out + "/metrics.csv";
    const bool is_new = !std::filesystem::exists(file);
    std::ofstream csv(file, std::ios::app);
    if (is_new)
        csv << "iteration,seconds,iterations_per_second,learning_rate,loss,gap_training_median,"
               "ms_prepare,ms_network,ms_solver,"
               "strain,bending,gravity,inertia,contact,friction,resets,"
               "gap_tshirt_median,gap_tshirt_p95,gap_sheet_median,gap_sheet_p95\n";
    const Sums& sums = *m_sums;
    const double n = std::max(1, sums.terms_count);
    const double rate = static_cast<double>(m_iteration - sums.first_iteration) /
                        std::max(1e-9, m_seconds - sums.first_second);
    const double lr = m_settings.recipe.learning_rate(m_iteration, progress());
    const double loss = sums.loss / sums.count, gap = median(sums.gaps);
    csv << m_iteration << ',' << m_seconds << ',' << rate << ',' << lr << ',' << loss << ',' << gap
        << ',' << 1e3 * sums.prepare_seconds / sums.count << ','
        << 1e3 * sums.network_seconds / sums.count << ',' << 1e3 * sums.solver_seconds / sums.count
        << ',' << sums.terms.strain / n << ',' << sums.terms.bending / n << ','
        << sums.terms.gravity / n << ',' << sums.terms.inertia / n << ',' << sums.terms.contact / n
        << ',' << sums.terms.friction / n << ',' << sums.resets;
    if (validation)
        csv << ',' << validation->tshirt.median << ',' << validation->tshirt.p95 << ','
            << validation->sheet.median << ',' << validation->sheet.p95 << '\n';
    else
        csv << ",,,,\n";
    const double part = progress();
    const double left = part > 0.0 ? m_seconds * (1.0 - part) / part / 60.0 : 0.0;
    std::fprintf(stderr, "%lld  %.2f it/s  loss %.4f  gap %.3f  lr %.1e  resets %d  %.0f min left",
                 static_cast<long long>(m_iteration), rate, loss, gap, lr, sums.resets, left);
    if (validation)
        std::fprintf(stderr, "  validation: T-shirt %.3f (p95 %.2f) sheet %.3f (p95 %.2f)",
                     validation->tshirt.median, validation->tshirt.p95, validation->sheet.median,
                     validation->sheet.p95);
    std::fprintf(stderr, "\n");
}

}  // namespace cloth
