#pragma once

#include "demos/doc_tables/registry.h"

namespace cloth {

/// Every committed report that tables are made from.
std::vector<DataSet> data_sets();

}  // namespace cloth
