#pragma once

#include "demos/doc_tables/registry.h"

namespace cloth {

/// Report of `engine_bench`, two threads.
MarkdownTable engine_table(const std::vector<DataFile>& files);
MarkdownTable bfloat16_table(const std::vector<DataFile>& files);
/// The same, one thread.
MarkdownTable edge_block_table(const std::vector<DataFile>& files);

/// Report of `step_bench`.
MarkdownTable step_table(const std::vector<DataFile>& files);

/// Report of `self_contact_bench`.
MarkdownTable self_contact_table(const std::vector<DataFile>& files);

}  // namespace cloth
