#include "demos/doc_tables/paper_data.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cloth {

using Json = nlohmann::ordered_json;

static constexpr double no_figure = std::numeric_limits<double>::quiet_NaN();

PaperData::PaperData(const DataFile& file)
    : m_file(&file),
      m_rows(file.rows("rows")),
      m_training(file.rows("training")),
      m_neighbours(file.rows("neighbours")) {
}

static const DataRow* row_of(const std::vector<DataRow>& rows, const std::string& garment,
                             const std::string& solver) {
    const auto at = std::find_if(rows.begin(), rows.end(), [&](const DataRow& row) {
        return row.text("/garment") == garment && row.text("/solver") == solver;
    });
    return at == rows.end() ? nullptr : &*at;
}

std::optional<DataRow> PaperData::row(const std::string& garment, const std::string& solver) const {
    const DataRow* row = row_of(m_rows, garment, solver);
    if (!row || row->has("/missing")) return std::nullopt;
    return *row;
}

std::string PaperData::missing(const std::string& garment, const std::string& solver) const {
    const DataRow* row = row_of(m_rows, garment, solver);
    return row && row->has("/missing") ? row->text("/missing") : "";
}

double PaperData::number(const std::string& garment, const std::string& solver,
                         const std::string& pointer) const {
    const std::optional<DataRow> found_row = row(garment, solver);
    return found_row && found_row->has(pointer) ? found_row->number(pointer) : no_figure;
}

std::vector<std::string> PaperData::solvers(const std::string& garment) const {
    std::vector<std::string> names;
    for (const DataRow& row : m_rows)
        if (row.text("/garment") == garment) names.push_back(row.text("/solver"));
    return names;
}

double PaperData::training(const std::string& network, const std::string& pointer) const {
    for (const DataRow& row : m_training)
        if (row.text("/network") == network) return row.number(pointer);
    return no_figure;
}

std::vector<std::string> PaperData::trained_networks() const {
    std::vector<std::string> names;
    for (const DataRow& row : m_training) names.push_back(row.text("/network"));
    return names;
}

std::vector<std::pair<double, double>> PaperData::history(const std::string& network) const {
    std::vector<std::pair<double, double>> points;
    for (const Json& row : m_file->content().at("training"))
        if (row.value("network", "") == network)
            for (const Json& point : row.value("history", Json::array()))
                points.emplace_back(point.at(0).get<double>(), point.at(1).get<double>());
    return points;
}

double PaperData::common_gap() const {
    double common = no_figure;
    for (const std::string& network : trained_networks()) {
        double least = no_figure;
        for (const auto& [iteration, gap] : history(network)) least = std::fmin(least, gap);
        common = std::fmax(common, least);
    }
    return common;
}

double PaperData::iterations_to(const std::string& network, double gap) const {
    for (const auto& [iteration, reached] : history(network))
        if (reached <= gap) return iteration;
    return no_figure;
}

int PaperData::neighbour_seeds(int count) const {
    return static_cast<int>(std::count_if(
        m_neighbours.begin(), m_neighbours.end(),
        [&](const DataRow& row) { return row.text("/name") == std::to_string(count); }));
}

double PaperData::neighbours(int count, const std::string& column) const {
    double sum = 0.0;
    for (const DataRow& row : m_neighbours)
        if (row.text("/name") == std::to_string(count))
            sum += row.has("/" + column) ? row.number("/" + column) : no_figure;
    const int seeds = neighbour_seeds(count);
    return seeds > 0 ? sum / seeds : no_figure;
}

}  // namespace cloth
