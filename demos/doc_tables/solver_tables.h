#pragma once

#include "demos/doc_tables/registry.h"

namespace cloth {

/// Reports of `compare` and `speed_error`: one garment, all solvers.
MarkdownTable whole_motion_table(const std::vector<DataFile>& files);
/// Solvers and what they do with a proxy, without times.
MarkdownTable proxy_table(const std::vector<DataFile>& files);
/// Fine garments over proxies, with and without a step of their own.
MarkdownTable detail_table(const std::vector<DataFile>& files);
MarkdownTable speed_error_table(const std::vector<DataFile>& files);
MarkdownTable which_solver_table(const std::vector<DataFile>& files);
/// All solvers that those of which_solver_table() are chosen from.
MarkdownTable small_steps_table(const std::vector<DataFile>& files);
/// Cotton as it is measured.
MarkdownTable stiff_table(const std::vector<DataFile>& files);
/// Median, 95 % and longest of the steps; a garment in each file, the same solvers in each.
/// Networks over proxies. @param files  of each of garments_over_proxies
MarkdownTable learned_table(const std::vector<DataFile>& files);
MarkdownTable real_time_table(const std::vector<DataFile>& files);
MarkdownTable bfloat16_rollout_table(const std::vector<DataFile>& files);

}  // namespace cloth
