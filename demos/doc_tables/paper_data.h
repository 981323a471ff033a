#pragma once

#include <optional>
#include <string>
#include <vector>

#include "demos/doc_tables/data_file.h"

namespace cloth {

/// What paper_tables.json has. Rows that are not there, or are "missing", give NaN.
class PaperData {
 public:
    /// @param file  must outlive this. @throws LoadError if it has not the lists
    explicit PaperData(const DataFile& file);

    /// Of "rows". Nothing if there is no such row, or its network is not trained.
    std::optional<DataRow> row(const std::string& garment, const std::string& solver) const;
    /// Why there is none, if the row says so; else empty.
    std::string missing(const std::string& garment, const std::string& solver) const;
    double number(const std::string& garment, const std::string& solver,
                  const std::string& pointer) const;
    /// The solvers of a garment, in the order of the file.
    std::vector<std::string> solvers(const std::string& garment) const;

    /// Of "training".
    double training(const std::string& network, const std::string& pointer) const;
    std::vector<std::string> trained_networks() const;
    /// The gap that all networks of "training" reached: the largest of their least.
    double common_gap() const;
    /// The first iteration at which a network had this gap; NaN: never.
    double iterations_to(const std::string& network, double gap) const;

    /// Of "neighbours": means over the seeds. NaN without rows.
    double neighbours(int count, const std::string& column) const;
    /// How many trainings the means are of.
    int neighbour_seeds(int count) const;

 private:
    std::vector<std::pair<double, double>> history(const std::string& network) const;

    const DataFile* m_file;
    std::vector<DataRow> m_rows, m_training, m_neighbours;
};

}  // namespace cloth
