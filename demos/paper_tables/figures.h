#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace cloth {

/// Figure 6: the energies of a report's detailed rows, frame by frame, as a table with a heading:
/// garment, solver, frame, and the terms (J).
std::string figure_6_csv(const nlohmann::ordered_json& report);

/// The same of `solver` (solid) and `other` (dashed) as SVG, a colour per term, on a logarithmic
/// axis. Without these rows: empty axes.
std::string figure_6_svg(const nlohmann::ordered_json& report, const std::string& solver,
                         const std::string& other);

/// Figure 7 as SVG: gaps against the number of sampled neighbours, means over the seeds.
std::string figure_7_svg(const nlohmann::ordered_json& report);

}  // namespace cloth
