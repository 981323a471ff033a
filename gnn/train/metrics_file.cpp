#include "gnn/train/metrics_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <utility>

#include "data/core/errors.h"

namespace cloth {

static std::string join(const MetricsFile::Row& cells) {
    std::string line;
    for (size_t k = 0; k < cells.size(); ++k) line += (k == 0 ? "" : ",") + cells[k];
    return line;
}

MetricsFile::MetricsFile(std::string path, Row columns)
    : m_path(std::move(path)), m_columns(std::move(columns)) {
}

void MetricsFile::keep_rows_up_to(std::int64_t iteration) {
    const std::string header = join(m_columns), temporary = m_path + ".tmp";
    std::ifstream before(m_path);
    std::ofstream kept(temporary);
    kept << header << '\n';
    std::string line;
    if (iteration > 0 && std::getline(before, line)) {
        if (line != header)
            throw LoadError(m_path, "line 1", "its columns are not those of this training",
                            "move the file away");
        const auto commas = std::count(header.begin(), header.end(), ',');
        while (std::getline(before, line)) {
            const bool ended = !before.eof();  // the last line may have been cut off
            if (ended && std::count(line.begin(), line.end(), ',') == commas &&
                std::atoll(line.c_str()) <= iteration)
                kept << line << '\n';
        }
    }
    kept.close();
    if (!kept || std::rename(temporary.c_str(), m_path.c_str()) != 0)
        throw LoadError(m_path, "", "cannot be written", "check free space and permissions");
}

void MetricsFile::append(const Row& cells) const {
    std::ofstream(m_path, std::ios::app) << join(cells) + '\n';
}

std::string cell(double value) {
    if (std::isnan(value)) return "";
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

std::string cell(std::int64_t value) {
    return std::to_string(value);
}

}  // namespace cloth
