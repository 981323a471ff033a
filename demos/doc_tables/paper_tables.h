#pragma once

#include <string>
#include <vector>

#include "demos/doc_tables/data_file.h"
#include "demos/doc_tables/markdown_table.h"

namespace cloth {

/// Report of `paper_tables`, beside the figures of FastClothGNN. One file each.

/// Table 1, with HOOD's rows of table 3.
MarkdownTable paper_training_table(const std::vector<DataFile>& files);
/// Table 2 of one garment, a row per solver, with HOOD's rows of table 3.
MarkdownTable paper_garment_table(const std::vector<DataFile>& files, const std::string& garment);
/// Table 3: HOOD + ours over HOOD, the two forms of a network on each garment.
MarkdownTable paper_hood_table(const std::vector<DataFile>& files);
/// Figure 6: means over the sequence by term.
MarkdownTable paper_terms_table(const std::vector<DataFile>& files);
/// Figure 7.
MarkdownTable paper_neighbours_table(const std::vector<DataFile>& files);
/// What the paper says, what was measured here, and whether it holds.
MarkdownTable paper_claims_table(const std::vector<DataFile>& files);

}  // namespace cloth
