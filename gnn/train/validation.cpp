#include "gnn/train/validation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "data/core/check_range.h"
#include "gnn/train/validation_names.h"

namespace cloth {

static const double full_contact_weight = PotentialSettings().contact_weight;

Points to_positions(const TrainingScene& scene, const torch::Tensor& output) {
    const torch::Tensor values = output.detach().to(torch::kCPU).contiguous();
    const Eigen::Map<const MatrixF> map(values.data_ptr<float>(), values.size(0), 3);
    const Features& features = scene.features();
    Points x = features.base + features.scale * map.cast<double>();
    for (int pin : scene.garment().pins()) x.row(pin) = features.base.row(pin);
    return x;
}

void ValidationSettings::check() const {
    check_range("ValidationSettings.garment_states", garment_states, 0, 1000);
    check_range("ValidationSettings.sheet_states", sheet_states, 0, 1000);
    check_range("ValidationSettings.rollout_iterations", rollout_iterations, 1, 1000);
    check_range("ValidationSettings.minimum_iterations", minimum_iterations, 1, 10000);
}

Validation::Validation(const SceneFactory& factory, ValidationSettings settings)
    : m_settings(settings) {
    m_settings.check();
    if (factory.has_garments() && settings.garment_states > 0) {
        const std::vector<std::string> clips = validation_clips();
        const int each = std::max(1, settings.garment_states / static_cast<int>(clips.size()));
        for (const std::string& clip : clips)
            add_states(factory.make_garment(1, clip, settings.garment), 32.0 / 30.0, 0.2, each);
    }
    for (int k = 0; k < settings.sheet_states; k += 2)
        add_states(factory.make_sheet(0x7e57000000ull + static_cast<std::uint64_t>(k)), 5.0 / 30.0,
                   1.0 / 3.0, 2);
}

/// @param first, every  (s) so that they are the same states at each time step; those of a garment
///                      come behind the second in which it settles on the body
void Validation::add_states(std::shared_ptr<TrainingScene> scene, double first, double every,
                            int count) {
    const auto frames = [&](double seconds) {
        return std::max(1, static_cast<int>(std::lround(seconds / scene->dt())));
    };
    const int first_frame = frames(first), step = frames(every);
    const int last = first_frame + step * (count - 1);
    for (int frame = 0; frame <= last; ++frame) {
        scene->prepare(full_contact_weight);
        Points x = scene->features().base;
        if (frame >= first_frame && (frame - first_frame) % step == 0) {
            Points minimum = x;
            const double least = scene->refine(minimum, m_settings.minimum_iterations);
            m_states.push_back({scene, scene->state, least, scene->potential().value(x), minimum});
        }
        scene->refine(x, m_settings.rollout_iterations);
        if (!scene->advance(x)) return;
    }
}

std::vector<double> Validation::times() const {
    std::vector<double> times;
    for (const State& state : m_states)
        times.push_back(state.state.time - state.scene->parts().start.time);
    return times;
}

static GapSummary summarise(std::vector<double> gaps, std::vector<double> errors) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    if (gaps.empty()) return {nan, nan, nan};
    std::sort(gaps.begin(), gaps.end());
    std::sort(errors.begin(), errors.end());
    const size_t n = gaps.size();
    const auto median = [n](const std::vector<double>& sorted) {
        return 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
    };
    return {median(gaps), gaps[std::min(n - 1, n * 95 / 100)], median(errors)};
}

template <typename Predict>
ValidationResult Validation::measure_with(Predict predict) {
    std::vector<double> gaps[2], errors[2];  // of garments and of sheets
    for (const State& state : m_states) {
        state.scene->state = state.state;
        state.scene->prepare(full_contact_weight);
        const Points x = predict(*state.scene);
        const double energy = state.scene->potential().value(x);
        const int kind = state.scene->parts().kind == "sheet";
        gaps[kind].push_back((energy - state.least) / std::max(state.base - state.least, 1e-12));
        errors[kind].push_back(1e3 * std::sqrt((x - state.minimum).rowwise().squaredNorm().mean()));
    }
    return {summarise(gaps[0], errors[0]), summarise(gaps[1], errors[1])};
}

ValidationResult Validation::measure(Network& network) {
    torch::NoGradGuard no_grad;
    return measure_with([&](const TrainingScene& scene) {
        return to_positions(scene, network.forward(scene.graph(), scene.features()));
    });
}

ValidationResult Validation::measure_solver(int iterations) {
    return measure_with([&](TrainingScene& scene) {
        Points x = scene.features().base;
        scene.refine(x, iterations);
        return x;
    });
}

}  // namespace cloth
