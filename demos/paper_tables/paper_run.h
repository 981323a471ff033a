#pragma once

#include "demos/compare/references.h"
#include "demos/paper_tables/options.h"

namespace cloth {

/// Measures what paper_tables.json in the folder has not, and writes it, the page and the figures.
/// @param threads  that solvers use
/// @throws UsageError, LoadError naming the option or file and the remedy
void run_paper_tables(const PaperOptions& options, int threads, const ProgressFunction& progress);

}  // namespace cloth
