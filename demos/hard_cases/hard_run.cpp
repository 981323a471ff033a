#include "demos/hard_cases/hard_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "collision/proximity/metrics.h"
#include "collision/self/self_tangles.h"
#include "demos/compare/lasting_loss.h"

namespace cloth {
namespace {

std::string text(const char* pattern, double value, double bound) {
    char line[96];
    std::snprintf(line, sizeof line, pattern, value, bound);
    return line;
}

/// Steps of the stepper's own length in one of the scene's.
int ticks_per_frame(const Stepper& stepper, const HardScene& scene) {
    if (stepper.fixed_dt() <= 0.0) return 1;
    return static_cast<int>(std::lround(scene.dt() / stepper.fixed_dt()));
}

/// Runs one case frame by frame and holds each against the bounds.
class HardMeter {
 public:
    HardMeter(const HardCase& hard, const HardScene& scene, Stepper& stepper,
              const std::vector<int>& kept, int start)
        : m_bounds(hard.bounds),
          m_in_full(scene.frames() >= hard.frames),
          m_scene(scene),
          m_stepper(stepper),
          m_state(scene.start_from(start)),
          m_tangles(scene.garment()),
          m_kept(kept) {}

    bool advance(int frame) {
        const Points before = m_state.x;
        const bool finite = step(frame);
        m_run.frames = frame + 1;
        if (!finite) {
            m_run.finite = false;
            fail(frame, "not finite");
            return false;
        }
        measure(frame, before);
        if (std::binary_search(m_kept.begin(), m_kept.end(), frame)) m_run.x.push_back(m_state.x);
        return true;
    }

    const HardRun& finish() {
        if (m_run.finite && m_in_full) check_the_end(m_run.frames - 1);
        return m_run;
    }

 private:
    Boundary boundary(int frame, int tick, int ticks) const {
        const double begin = (frame + static_cast<double>(tick) / ticks) * m_scene.dt();
        const double end = (frame + static_cast<double>(tick + 1) / ticks) * m_scene.dt();
        return m_scene.boundary(begin, end);
    }

    bool step(int frame) {
        const int ticks = ticks_per_frame(m_stepper, m_scene);
        const double dt = m_stepper.fixed_dt() > 0.0 ? m_stepper.fixed_dt() : m_scene.dt();
        std::chrono::duration<double, std::milli> time{};
        bool finite = true;
        for (int tick = 0; tick < ticks && finite; ++tick) {
            const Boundary now = boundary(frame, tick, ticks);
            const auto begin = std::chrono::steady_clock::now();
            finite = m_stepper.step(now, dt, m_state).finite;
            time += std::chrono::steady_clock::now() - begin;
        }
        m_run.ms.push_back(time.count());
        return finite && m_state.x.allFinite();
    }

    void measure(int frame, const Points& before) {
        Boundary outside = m_scene.boundary_of_frame(frame);
        const Garment& garment = m_scene.garment();
        const Points motion = m_state.x - before;
        outside.ignored_limbs = m_stepper.ignored_limbs();
        m_run.penetration_mm.push_back(1e3 * deepest_free_vertex(outside));
        outside.ignored_limbs.clear();
        m_run.surface_mm.push_back(
            1e3 * measure_penetration(m_proximity, outside, garment, m_state.x).max_depth);
        m_run.stretch_p99.push_back(measure_stretch(garment, m_state.x).p99);
        m_run.rms_speed.push_back(rms(motion) / m_scene.dt());
        m_motion_mm.push_back(1e3 * rms(motion));
        if (m_bounds.tangles)
            m_run.tangles.push_back(static_cast<int>(m_tangles.find(m_state.x).size()));
        check(frame);
        if (is_impaled(outside, garment.rest().faces, m_state.x))
            fail(frame, "a limb is through the cloth");
        const std::string loss = m_scene.loss(outside, m_state.x);
        const bool is_last = frame + 1 == m_scene.frames();
        if (const auto since = m_loss.add(frame, !loss.empty(), is_last, m_scene.dt()))
            fail(*since, loss);
    }

    /// Pins are where the scene puts them.
    double deepest_free_vertex(const Boundary& outside) {
        VectorX distance;
        m_proximity.signed_distance(m_state.x, outside, StepEnd::end, distance);
        for (const int pin : m_scene.garment().pins()) distance[pin] = 0.0;
        return std::max(0.0, -distance.minCoeff());
    }

    static double rms(const Points& motion) {
        return std::sqrt(motion.squaredNorm() / static_cast<double>(motion.rows()));
    }

    void check(int frame) {
        const double depth = m_run.penetration_mm.back(), stretch = m_run.stretch_p99.back();
        const double speed = m_run.rms_speed.back();
        if (depth > m_bounds.penetration_mm)
            fail(frame, text("%.1f mm inside (at most %.1f)", depth, m_bounds.penetration_mm));
        if (m_bounds.stretch_p99 && stretch > *m_bounds.stretch_p99)
            fail(frame, text("stretched to %.2f (at most %.2f)", stretch, *m_bounds.stretch_p99));
        if (m_bounds.rms_speed && speed > *m_bounds.rms_speed)
            fail(frame, text("RMS speed %.1f m/s (at most %.1f)", speed, *m_bounds.rms_speed));
        if (m_bounds.tangles && m_run.tangles.back() > *m_bounds.tangles)
            fail(frame, text("%.0f edges pass through faces (at most %.0f)", m_run.tangles.back(),
                             *m_bounds.tangles));
    }

    void check_the_end(int frame) {
        const double stretch = m_run.stretch_p99.back();
        if (m_bounds.end_stretch_p99 && stretch > *m_bounds.end_stretch_p99)
            fail(frame, text("still stretched to %.2f at the end (at most %.2f)", stretch,
                             *m_bounds.end_stretch_p99));
        const double top = *std::max_element(m_run.rms_speed.begin(), m_run.rms_speed.end());
        if (m_bounds.least_top_speed && top < *m_bounds.least_top_speed)
            fail(frame, text("slow motion: RMS speed at most %.2f m/s (at least %.2f)", top,
                             *m_bounds.least_top_speed));
        double squares = 0.0;
        const size_t all = m_motion_mm.size(), first = all - all / 3;
        for (size_t k = first; k < all; ++k) squares += m_motion_mm[k] * m_motion_mm[k];
        const double jitter = std::sqrt(squares / static_cast<double>(all - first));
        m_run.rest_jitter_mm = jitter;
        if (m_bounds.rest_jitter_mm && jitter > *m_bounds.rest_jitter_mm)
            fail(frame, text("moves %.3f mm per frame at rest (at most %.3f)", jitter,
                             *m_bounds.rest_jitter_mm));
    }

    void fail(int frame, const std::string& how) {
        if (m_run.first_failed_frame) return;
        m_run.first_failed_frame = frame;
        m_run.failure = how;
    }

    const Bounds& m_bounds;
    bool m_in_full;
    const HardScene& m_scene;
    Stepper& m_stepper;
    Proximity m_proximity;
    ClothState m_state;
    SelfTangles m_tangles;
    const std::vector<int>& m_kept;
    std::vector<double> m_motion_mm;
    LastingLoss m_loss;
    HardRun m_run;
};

}  // namespace

std::vector<int> picture_frames(int frames) {
    std::vector<int> pictures = {0, frames / 2, frames - 1};
    pictures.erase(std::unique(pictures.begin(), pictures.end()), pictures.end());
    return pictures;
}

std::string not_applicable(const Stepper& stepper, const HardScene& scene) {
    const double fixed = stepper.fixed_dt();
    if (fixed <= 0.0) return {};
    const int ticks = ticks_per_frame(stepper, scene);
    if (ticks >= 1 && std::abs(ticks * fixed - scene.dt()) < 1e-9) return {};
    return text("not applicable: takes steps of %.4f s, which make no frame of %.4f s", fixed,
                scene.dt());
}

HardRun run_hard_case(const HardCase& hard, const HardScene& scene, Stepper& stepper,
                      const std::vector<int>& frames, const std::function<void(int)>& done,
                      int start) {
    HardMeter meter(hard, scene, stepper, frames, start);
    for (int frame = 0; frame < scene.frames() && meter.advance(frame); ++frame) done(frame + 1);
    return meter.finish();
}

}  // namespace cloth
