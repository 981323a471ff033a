#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace cloth {

/// One column of a report's table: where its numbers are in a solver's entry, and what they mean.
struct ReportColumn {
    std::string heading;
    std::string unit;         ///< empty: a plain number
    std::string path;         ///< JSON pointer into the solver's entry, such as "/rollout/rmse_mm"
    std::string explanation;  ///< one sentence
    bool lowest_is_best = true;  ///< mark the lowest value; false: no value is best
    double factor = 1.0;         ///< from the entry's unit to the column's
};

/// A number of a solver's entry; NaN where it is null or missing.
double number_at(const nlohmann::json& solver, const std::string& path);

/// A number as people read it: three digits, no exponent if that can be avoided; a dash for NaN.
std::string short_number(double value);

/// Whether a solver takes part in the contest for the best value: it is not the reference, which
/// the others are measured against, and its run did not fail.
bool competes(const nlohmann::json& solver);

/// A table with a row per solver, the best values marked and every column explained below.
/// @param solvers  the list of the report; entries that are no objects count as empty
std::string table_html(const nlohmann::json& solvers, const std::vector<ReportColumn>& columns);

}  // namespace cloth
