#pragma once

#include <string>

#include "demos/doc_tables/registry.h"

namespace cloth {

/// Runs the command of a data set and puts what it writes in the place of the committed file, whole
/// or not at all.
/// @param root   of the sources; the command runs there, and OUT is out/doc_tables/NAME in it
/// @param build  folder of the programs, instead of build/release
/// @throws LoadError naming the command or file, the problem and the remedy; the committed file is
///         then as it was
void measure(const DataSet& set, const std::string& root, const std::string& build);

}  // namespace cloth
