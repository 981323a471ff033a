#pragma once

#include <string>

#include "demos/compare/options.h"

namespace cloth {

/// Where compare keeps a result until all are there. @param name  may hold "/": solvers may be
/// named after files
std::string work_file(const CompareOptions& options, const std::string& name);

/// Makes the folder of the parts, and removes what was computed with other settings, of other
/// files, or by another program: all of it if the scene was another one, else the results of the
/// solvers whose weights have changed.
/// @throws LoadError if its record is damaged, or a file cannot be read
void prepare_work_folder(const CompareOptions& options);

}  // namespace cloth
