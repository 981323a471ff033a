#pragma once

#include "demos/doc_tables/registry.h"

namespace cloth {

/// Report of `scaling`: a row per scene and size, the solvers side by side.
MarkdownTable scaling_table(const std::vector<DataFile>& files);

/// Report of `many_characters`: a row per solver and way of stepping.
MarkdownTable many_characters_table(const std::vector<DataFile>& files);

}  // namespace cloth
