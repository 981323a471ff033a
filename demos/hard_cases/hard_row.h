#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "demos/hard_cases/hard_run.h"

namespace cloth {

/// One solver in one case: a row of hard_cases.json. NaN: there is no such figure.
struct HardRow {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

    std::string hard_case, stepper;
    /// What it was measured with, where the case does not tell: a garment, and what tells files
    /// apart.
    std::string inputs;
    std::optional<bool> held;  ///< nothing: it was not run, `failure` says why
    bool finite = true;
    double penetration_max_mm = unknown, penetration_bound_mm = unknown;
    double surface_max_mm = unknown;  ///< edge midpoints and face centres included; no bound
    double stretch_p99 = unknown, stretch_bound = unknown;  ///< in the worst frame
    double end_stretch_p99 = unknown;                       ///< in the last frame
    double rest_jitter_mm = unknown;
    double rms_speed_max = unknown;
    std::optional<int> first_failed_frame;
    std::string failure;
    /// Of a frame's steps, without the animation of obstacles. The first frame, which builds what
    /// the others use, counts for the median only.
    double ms_median = unknown, ms_p95 = unknown, ms_longest = unknown;
    int frames = 0;  ///< that it lasted
    int frames_wanted = 0;
    int starts = 1;  ///< see HardScene::start_from(); all figures above are of the first one's run
    int starts_held = 0;
};

HardRow make_row(const HardCase& hard, const std::string& stepper, const HardRun& run,
                 int frames_wanted);
/// A case that was not run with this stepper.
HardRow skipped_row(const HardCase& hard, const std::string& stepper, const std::string& reason,
                    int frames_wanted);
/// A case whose garment the stepper does not take.
HardRow refused_row(const HardCase& hard, const std::string& stepper, const std::string& error,
                    int frames_wanted);

nlohmann::ordered_json to_json(const HardRow& row);
/// @throws nlohmann::json::exception if it is no row
HardRow row_from_json(const nlohmann::ordered_json& json);

/// One line per row, for a terminal.
std::string text_line(const HardRow& row);

/// A table of cases against steppers for a text in Markdown, with what failed and where.
std::string markdown(const std::vector<HardRow>& rows);

}  // namespace cloth
