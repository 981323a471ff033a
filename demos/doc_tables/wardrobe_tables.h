#pragma once

#include "demos/doc_tables/registry.h"

namespace cloth {

/// Report of `generalisation`: a row per solver, a column per group of scenes.
MarkdownTable generalisation_table(const std::vector<DataFile>& files);

/// Report of `lookbook`: a row per garment, the bodies side by side.
MarkdownTable lookbook_table(const std::vector<DataFile>& files);

}  // namespace cloth
