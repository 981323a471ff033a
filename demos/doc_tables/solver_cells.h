#pragma once

#include <array>
#include <string>

#include "demos/doc_tables/data_file.h"

namespace cloth {

/// What the tables `learned` and `alone` measure, in the order of their files.
constexpr std::array<const char*, 3> garments_over_proxies = {"T-shirt", "pants", "dress"};

/// A distance in mm, to the millimetre, below 10 to a tenth of it.
std::string millimetres(double value);

/// When and how a solver's run failed: its first_failed_frame and failure; a dash if it did not.
std::string failure_of(const DataRow& row);

}  // namespace cloth
