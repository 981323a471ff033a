#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cloth {

/// A table in a CSV file, one row after another, the first column an iteration.
class MetricsFile {
 public:
    using Row = std::vector<std::string>;

    MetricsFile(std::string path, Row columns);

    /// What a training that goes on from an iteration has to find: the complete rows up to there.
    /// Later ones will be written again.
    /// @throws LoadError if the file has other columns or cannot be written
    void keep_rows_up_to(std::int64_t iteration);

    /// Appends a row of as many cells as there are columns.
    void append(const Row& cells) const;

    const std::string& path() const { return m_path; }

 private:
    std::string m_path;
    Row m_columns;
};

/// Six digits; empty for NaN.
std::string cell(double value);
std::string cell(std::int64_t value);

}  // namespace cloth
