#include "gnn/train/rollout_validation.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>
#include <utility>

#include "collision/proximity/metrics.h"
#include "data/core/check_range.h"
#include "gnn/model/make_proxy_cloth.h"
#include "gnn/train/reference_file.h"
#include "gnn/train/reference_fingerprint.h"
#include "gnn/train/sheet_world.h"
#include "gnn/train/validation_names.h"

namespace cloth {

namespace {

double rms_distance(const Points& a, const Points& b) {
    return std::sqrt((a - b).rowwise().squaredNorm().mean());
}

}  // namespace

struct RolloutValidation::Scene {
    std::string name;
    std::string garment;  ///< empty: a sheet
    std::unique_ptr<TrainingScene> scene;
    int lead_in = 0;                ///< frames
    std::vector<Points> reference;  ///< after the lead-in, and after each frame
    Points start_velocities;

    Boundary boundary(double time) const {
        Boundary out;
        scene->parts().world->boundary(time, scene->dt(), out);
        return out;
    }
    ClothState start() const {
        return {reference.front(), start_velocities,
                scene->parts().start.time + lead_in * scene->dt()};
    }
};

void RolloutSettings::check() const {
    if (sheet_vertices != 0)
        check_range("RolloutSettings.sheet_vertices", sheet_vertices, 9, 200000);
    check_range("RolloutSettings.frames", frames, 1, 10000);
    for (const int count : iterations) check_range("RolloutSettings.iterations", count, 0, 100);
    check_range("RolloutSettings.reference_iterations", reference_iterations, 1, 1000);
    check_range("RolloutSettings.threads", threads, 1, 256);
}

RolloutValidation::RolloutValidation(const SceneFactory& factory, const RolloutSettings& settings,
                                     const std::string& folder)
    : m_settings(settings), m_folder(folder) {
    m_settings.check();
    check_clips(m_settings.clips);
    add_garments(factory);
    if (m_settings.sheet_vertices == 0) return;
    for (const bool held : {true, false})
        m_scenes.push_back(std::make_unique<Scene>(
            Scene{held ? "sheet-hanging" : "sheet-sphere",
                  "",
                  factory.finish(make_test_sheet(m_settings.sheet_vertices, held)),
                  0,
                  {},
                  {}}));
}

RolloutValidation::~RolloutValidation() = default;

void RolloutValidation::add_garments(const SceneFactory& factory) {
    std::vector<std::string> known;
    if (factory.has_garments()) known = factory.garment_names();
    const std::vector<size_t> chosen = validated_garments(m_settings.garments, known);
    if (!chosen.empty() && m_settings.clips.empty()) m_settings.clips = default_rollout_clips();
    for (const size_t index : chosen)
        for (const std::string& clip : m_settings.clips) {
            auto scene = factory.make_garment(1, clip, index);
            const int lead_in =
                static_cast<int>(std::lround(AnimationSettings().lead_in / scene->dt()));
            m_scenes.push_back(std::make_unique<Scene>(Scene{clip_name(clip, m_settings.clips),
                                                             known[index],
                                                             std::move(scene),
                                                             lead_in,
                                                             {},
                                                             {}}));
        }
}

/// @return false: stopped
bool RolloutValidation::find_reference(Scene& scene, const std::atomic<bool>& stop) const {
    if (!scene.reference.empty()) return true;
    const Garment& garment = scene.scene->garment();
    const ClothState& start = scene.scene->parts().start;
    std::ostringstream name;
    const int frames = scene.lead_in + m_settings.frames;
    name << m_folder << '/' << std::filesystem::path(scene.name).stem().string() << '_'
         << garment.vertex_count() << '_' << m_settings.frames << '_'
         << m_settings.reference_iterations << '_' << std::hex
         << reference_fingerprint(*scene.scene, frames) << ".pt";
    const std::string file = name.str();
    if (load_reference(file, garment.vertex_count(), m_settings.frames, scene.reference,
                       scene.start_velocities))
        return true;
    NewtonSettings newton;
    newton.max_iterations = m_settings.reference_iterations;
    ClothStepperSettings solver = ClothStepperSettings::reference(newton);
    solver.guard = GuardSettings::limbs_alone();
    ClothStepper stepper(garment, solver);
    ClothState state = start;
    std::vector<Points> trajectory;
    for (int frame = 0; frame < frames; ++frame) {
        if (stop) return false;
        if (frame == scene.lead_in) {
            trajectory = {state.x};
            scene.start_velocities = state.v;
        }
        stepper.step(scene.boundary(state.time), scene.scene->dt(), state);
        if (frame >= scene.lead_in) trajectory.push_back(state.x);
    }
    scene.reference = std::move(trajectory);
    save_reference(file, scene.reference, scene.start_velocities);
    return true;
}

/// @return false: stopped
bool RolloutValidation::roll(const Scene& scene, Stepper& stepper, RolloutResult& result,
                             const std::atomic<bool>& stop) const {
    ClothState state = scene.start();
    double sum = 0.0;
    while (result.held < m_settings.frames && result.failure.empty()) {
        if (stop) return false;
        const StepReport report =
            stepper.step(scene.boundary(state.time), scene.scene->dt(), state);
        const double distance =
            rms_distance(state.x, scene.reference[static_cast<size_t>(result.held) + 1]);
        const double stretch = measure_stretch(scene.scene->garment(), state.x).p99;
        if (!report.finite || !state.x.allFinite()) {
            result.failure = "not finite";
            break;
        }
        result.stretch = std::max(result.stretch, stretch);
        result.penetration = std::max(result.penetration, report.max_penetration);
        if (stretch > 2.0)
            result.failure = "torn";
        else if (!(distance <= RolloutResult::lost_distance))
            result.failure = "lost";
        else {
            sum += distance;
            ++result.held;
        }
    }
    sum += RolloutResult::lost_distance * (m_settings.frames - result.held);
    result.distance = sum / m_settings.frames;
    return true;
}

bool RolloutValidation::prepare(const std::atomic<bool>& stop) {
    return std::all_of(m_scenes.begin(), m_scenes.end(),
                       [&](const auto& scene) { return find_reference(*scene, stop); });
}

std::unique_ptr<Stepper> RolloutValidation::make_stepper(
    const Scene& scene, const std::shared_ptr<const EngineWeights>& weights, int iterations) const {
    const Garment& garment = scene.scene->garment();
    if (const auto& proxy = scene.scene->parts().proxy) {
        ProxyClothSettings settings;
        settings.proxy.step.proximity.threads = m_settings.threads;
        settings.embedded.proximity.threads = m_settings.threads;
        settings.embedded.detail_iterations = iterations;
        settings.detail = weights;
        settings.engine.threads = m_settings.threads;
        return make_proxy_cloth(garment, proxy, settings);
    }
    ClothSettings settings;
    settings.weights = weights;
    settings.step = StepSettings::whole(IterationLimits::exactly(iterations));
    settings.step.proximity.threads = m_settings.threads;
    settings.engine.threads = m_settings.threads;
    settings.guard = GuardSettings::limbs_alone();
    return make_cloth(garment, settings);
}

std::optional<std::vector<RolloutResult>> RolloutValidation::measure(
    const Weights& weights, const std::atomic<bool>& stop) {
    if (!prepare(stop)) return std::nullopt;
    const auto packed = std::make_shared<const EngineWeights>(weights);
    std::vector<RolloutResult> results;
    for (const auto& scene : m_scenes) {
        for (const int iterations : m_settings.iterations) {
            const auto stepper = make_stepper(*scene, packed, iterations);
            RolloutResult result;
            result.scene = scene->name;
            result.garment = scene->garment;
            result.iterations = iterations;
            result.frames = m_settings.frames;
            if (!roll(*scene, *stepper, result, stop)) return std::nullopt;
            results.push_back(result);
        }
    }
    return results;
}

RolloutSummary summarise(const std::vector<RolloutResult>& results, bool sheets, int iterations) {
    RolloutSummary sum;
    int count = 0;
    for (const RolloutResult& result : results) {
        if (result.is_sheet() != sheets || result.iterations != iterations) continue;
        sum.held += result.held;
        sum.distance_mm += 1e3 * result.distance;
        sum.stretch += result.stretch;
        ++count;
    }
    const double n = count > 0 ? count : std::numeric_limits<double>::quiet_NaN();
    return {sum.held / n, sum.distance_mm / n, sum.stretch / n};
}

}  // namespace cloth
