#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace cloth {

/// All tables of a report as one page of Markdown. @throws LoadError if the report has not its
/// lists
std::string paper_page(const std::string& path, const nlohmann::ordered_json& report);

}  // namespace cloth
