#pragma once

#include <string>

namespace cloth {

/// The processor's name and number of cores, for reports.
std::string machine_name();

}  // namespace cloth
