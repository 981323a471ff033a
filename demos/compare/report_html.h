#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace cloth {

/// Files that a report shows; they are copied into it.
struct ReportPictures {
    std::vector<std::string> key_frames;  ///< PNG; "key_frame_12.png" is captioned as frame 12
    std::string video;                    ///< MP4; empty: none
};

/// A comparison as one HTML page that needs no other file: summary, video, key frames, tables with
/// the best values marked and every column explained, diagrams, and notes on what the figures do
/// not say. Equal input gives equal text.
/// @param report  as written to report.json: `scene` and `solvers`, with per-frame `series`.
/// Numbers
///                that are null or missing are shown as a dash.
/// @throws ArgumentError if `scene` is no object or `solvers` no list of objects
/// @throws LoadError naming the picture or video that cannot be read
std::string report_html(const nlohmann::json& report, const ReportPictures& pictures);

}  // namespace cloth
