#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace cloth {

/// The diagrams of a report as HTML figures: error, single-step gap, time and penetration per
/// frame, and time against error. Diagrams without any value are left out.
std::string plots_html(const nlohmann::json& report);

}  // namespace cloth
