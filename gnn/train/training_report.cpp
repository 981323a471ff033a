#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>

#include "gnn/train/training_run.h"

namespace cloth {

using torch::Tensor;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

double median(std::vector<double> values) {
    if (values.empty()) return none;
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
}

MetricsFile::Row metrics_columns(const std::vector<int>& iterations) {
    MetricsFile::Row columns = {"iteration",
                                "seconds",
                                "iterations_per_second",
                                "learning_rate",
                                "loss",
                                "gap_training_median",
                                "error_training_median",
                                "ms_prepare",
                                "ms_network",
                                "ms_solver",
                                "strain",
                                "bending",
                                "gravity",
                                "inertia",
                                "contact",
                                "friction",
                                "resets",
                                "kicks",
                                "gap_tshirt_median",
                                "gap_tshirt_p95",
                                "error_tshirt_mm",
                                "gap_sheet_median",
                                "gap_sheet_p95",
                                "error_sheet_mm"};
    for (const char* scene : {"garment", "sheet"})
        for (const int count : iterations)
            for (const char* value : {"frames", "mm", "stretch"})
                columns.push_back(std::string(scene) + "_rollout_" + std::to_string(count) + "_" +
                                  value);
    columns.push_back("validation_seconds");
    return columns;
}

MetricsFile::Row rollout_columns() {
    return {"iteration", "scene",   "garment", "iterations", "frames",
            "held",      "failure", "mean_mm", "stretch",    "penetration_mm"};
}

/// A dash for what was not measured.
std::string measured(int digits, double value) {
    if (std::isnan(value)) return "-";
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", digits, value);
    return text;
}

/// "3 h 07 min"
std::string duration_text(double seconds) {
    const long minutes = std::lround(seconds / 60.0);
    char text[64];
    if (minutes >= 60)
        std::snprintf(text, sizeof text, "%ld h %02ld min", minutes / 60, minutes % 60);
    else
        std::snprintf(text, sizeof text, "%ld min", minutes);
    return text;
}

/// "3 h 07 min left, done on Mon 04:12"
std::string end_text(double seconds) {
    const std::time_t end = std::time(nullptr) + static_cast<std::time_t>(seconds);
    std::tm local{};
    localtime_r(&end, &local);
    char text[64];
    std::strftime(text, sizeof text, " left, done on %a %d %b %H:%M", &local);
    return duration_text(seconds) + text;
}

}  // namespace

Trainer::Run::Run(const TrainerSettings& settings, const std::atomic<bool>& stop_flag,
                  double trained, std::int64_t iteration)
    : stop(stop_flag),
      metrics(settings.out + "/metrics.csv", metrics_columns(settings.rollouts.iterations)),
      rollouts(settings.out + "/rollouts.csv", rollout_columns()),
      budget(settings.validation_share, 60.0 * settings.validate_every, trained),
      seconds_before(trained),
      first_iteration(iteration) {
    metrics.keep_rows_up_to(iteration);
    rollouts.keep_rows_up_to(iteration);
}

struct Trainer::Validated {
    bool done = false;
    ValidationResult steps;
    std::vector<RolloutResult> rollouts;
    double seconds = 0.0;
};

void Trainer::begin_sums() {
    m_sums = TrainingSums();
    m_sums.first_iteration = m_iteration;
    m_sums.first_second = m_seconds;
}

void Trainer::run(const std::atomic<bool>& stop) {
    start();
    if (m_group.is_first()) m_run = std::make_unique<Run>(m_settings, stop, m_seconds, m_iteration);
    if (!is_filled()) fill_pools(stop);
    begin_sums();
    double saved = m_seconds;
    for (;;) {
        const double now = m_run ? m_run->seconds() : 0.0;
        const bool saves = m_run && now - saved > 60.0 * m_settings.save_every;
        Tensor agreed = torch::tensor(
            {stop ? 1.0 : 0.0, is_filled() ? 0.0 : 1.0, saves ? 1.0 : 0.0, now}, torch::kFloat64);
        m_group.sum(agreed);
        const auto said = [&](int k) { return agreed[k].item<double>(); };
        m_seconds = said(3);
        if (said(1) > 0.0) return;  // stopped before the first iteration
        if (said(0) > 0.0 || is_done()) {
            save();
            if (m_run) report(said(0) == 0.0 && m_settings.validation_share > 0.0);
            return;
        }
        if (said(2) > 0.0) {
            save();
            saved = m_seconds;
        }
        iterate();
        if (!m_run) continue;
        m_seconds = m_run->seconds();
        if (m_iteration % m_settings.report_every == 0 && !is_done())
            report(m_run->budget.is_due(m_seconds));
    }
}

void Trainer::report(bool validates) {
    if (m_sums.count == 0 && !validates) return;
    Validated validated;
    if (validates) validated = validate();
    write_row(validated);
    say(validated);
    m_seconds = m_run->seconds();
    begin_sums();
}

/// States and references are made when they are first needed; that counts as validation too.
Trainer::Validated Trainer::validate() {
    double start = m_run->seconds();
    if (!m_validation) {
        m_validation = std::make_unique<Validation>(m_factory, m_settings.validation);
        for (const int k : {1, 3}) {
            const ValidationResult solver = m_validation->measure_solver(k);
            std::fprintf(stderr, "solver, %d iterations: gap garment %s, sheet %s\n", k,
                         measured(3, solver.tshirt.median).c_str(),
                         measured(3, solver.sheet.median).c_str());
        }
        m_rollouts->prepare(m_run->stop);
        m_run->budget.spent(m_run->seconds() - start, m_run->seconds());
        start = m_run->seconds();
    }
    Validated validated;
    {
        const WithMean mean(*this);
        validated.steps = m_validation->measure(m_network);
    }
    auto rollouts = m_rollouts->measure(weights(), m_run->stop);
    m_run->budget.spent(m_run->seconds() - start, m_run->seconds());
    validated.done = rollouts.has_value();
    if (rollouts) validated.rollouts = std::move(*rollouts);
    validated.seconds = m_run->budget.total();
    return validated;
}

void Trainer::write_row(const Validated& validated) {
    const TrainingSums& sums = m_sums;
    const double terms = sums.terms_count > 0 ? sums.terms_count : none;
    const double count = sums.count > 0 ? sums.count : none;
    const double learning_rate = m_settings.recipe.learning_rate(m_iteration, progress());
    MetricsFile::Row row = {cell(m_iteration)};
    for (const double value :
         {m_seconds, iterations_per_second(), learning_rate, sums.loss / count, median(sums.gaps),
          median(sums.errors), 1e3 * sums.prepare_seconds / count,
          1e3 * sums.network_seconds / count, 1e3 * sums.solver_seconds / count,
          sums.terms.strain / terms, sums.terms.bending / terms, sums.terms.gravity / terms,
          sums.terms.inertia / terms, sums.terms.contact / terms, sums.terms.friction / terms,
          static_cast<double>(sums.resets), static_cast<double>(sums.kicks)})
        row.push_back(cell(value));
    const bool done = validated.done;
    for (const GapSummary& gap : {validated.steps.tshirt, validated.steps.sheet})
        for (const double value : {gap.median, gap.p95, gap.error_mm})
            row.push_back(cell(done ? value : none));
    for (const bool sheets : {false, true})
        for (const int iterations : m_settings.rollouts.iterations) {
            const RolloutSummary mean = summarise(validated.rollouts, sheets, iterations);
            for (const double value : {mean.held, mean.distance_mm, mean.stretch})
                row.push_back(cell(value));
        }
    row.push_back(cell(done ? validated.seconds : none));
    m_run->metrics.append(row);
    for (const RolloutResult& result : validated.rollouts)
        m_run->rollouts.append(
            {cell(m_iteration), result.scene, result.garment, std::to_string(result.iterations),
             std::to_string(result.frames), std::to_string(result.held), result.failure,
             cell(1e3 * result.distance), cell(result.stretch), cell(1e3 * result.penetration)});
}

/// Since the last row; NaN where there was none.
double Trainer::iterations_per_second() const {
    if (m_iteration == m_sums.first_iteration) return none;
    return static_cast<double>(m_iteration - m_sums.first_iteration) /
           std::max(1e-9, m_seconds - m_sums.first_second);
}

/// Of the clock (s), by the speed since this run began.
double Trainer::seconds_left() const {
    double left = std::numeric_limits<double>::infinity();
    if (m_settings.minutes > 0.0) left = 60.0 * m_settings.minutes - m_seconds;
    const std::int64_t trained = m_iteration - m_run->first_iteration;
    if (m_settings.iterations > 0 && trained > 0)
        left = std::min(left, (m_seconds - m_run->seconds_before) / static_cast<double>(trained) *
                                  static_cast<double>(m_settings.iterations - m_iteration));
    return std::max(0.0, left);
}

void Trainer::say(const Validated& validated) const {
    std::fprintf(stderr, "%lld  %s it/s  loss %s  gap %s  resets %d  %s\n",
                 static_cast<long long>(m_iteration), measured(2, iterations_per_second()).c_str(),
                 measured(4, m_sums.count > 0 ? m_sums.loss / m_sums.count : none).c_str(),
                 measured(3, median(m_sums.gaps)).c_str(), m_sums.resets,
                 end_text(seconds_left()).c_str());
    if (!validated.done) return;
    const ValidationResult& steps = validated.steps;
    const auto gap = [](const GapSummary& of) {
        return measured(3, of.median) + ", " + measured(1, of.error_mm);
    };
    std::fprintf(stderr, "  one step: garment gap %s mm; sheet gap %s mm\n",
                 gap(steps.tshirt).c_str(), gap(steps.sheet).c_str());
    for (const RolloutResult& result : validated.rollouts)
        std::fprintf(stderr, "  %s %s +%d: %d of %d frames, %.0f mm, stretch %.2f %s\n",
                     result.scene.c_str(), result.garment.c_str(), result.iterations, result.held,
                     result.frames, 1e3 * result.distance, result.stretch, result.failure.c_str());
}

}  // namespace cloth
