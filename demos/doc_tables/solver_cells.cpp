#include "demos/doc_tables/solver_cells.h"

#include "demos/doc_tables/markdown_table.h"

namespace cloth {

std::string millimetres(double value) {
    return decimals(value, value < 9.95 ? 1 : 0);
}

std::string failure_of(const DataRow& row) {
    if (row.is_null("/first_failed_frame")) return "–";
    return "frame " + decimals(row.number("/first_failed_frame"), 0) + ": " + row.text("/failure");
}

}  // namespace cloth
