#pragma once

#include <string>

#include "demos/doc_tables/data_file.h"

namespace cloth {

/// A distance in mm, to the millimetre, below 10 to a tenth of it.
std::string millimetres(double value);

/// When and how a solver's run failed: its first_failed_frame and failure; a dash if it did not.
std::string failure_of(const DataRow& row);

}  // namespace cloth
