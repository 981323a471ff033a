#pragma once

#include <string>
#include <vector>

#include "demos/hard_cases/hard_row.h"

namespace cloth {

/// The rows of hard_cases.json, whole on disk after every change.
class HardReport {
 public:
    /// @param threads  that the solvers use, for the report
    /// @param resume   begin with the rows that the file has
    /// @throws LoadError if there is a file that is no report or that another program has written
    HardReport(std::string path, int threads, bool resume);

    /// A row of the same case, stepper, number of frames and inputs, from at least so many starts;
    /// null: there is none.
    const HardRow* find(const std::string& hard_case, const std::string& stepper, int frames_wanted,
                        int starts = 1, const std::string& inputs = "") const;
    /// Puts a row in the place of one of the same case and stepper, or at the end.
    void add(const HardRow& row);

    const std::vector<HardRow>& rows() const { return m_rows; }

 private:
    std::string m_path;
    nlohmann::ordered_json m_provenance;
    std::vector<HardRow> m_rows;
};

}  // namespace cloth
