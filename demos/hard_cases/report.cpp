#include "demos/hard_cases/report.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "data/core/errors.h"
#include "data/core/read_file.h"
#include "demos/provenance/provenance.h"
#include "render/replaced_file.h"

namespace cloth {

using nlohmann::ordered_json;

static std::vector<HardRow> load_rows(const std::string& path) {
    std::vector<HardRow> rows;
    if (!std::filesystem::exists(path)) return rows;
    try {
        const ordered_json document = ordered_json::parse(read_file(path));
        const std::string commit = document.at("provenance").at("commit").get<std::string>();
        if (commit != build_commit())
            throw LoadError(path, "provenance",
                            "is of commit " + commit + ", not " + build_commit(),
                            "delete it, or run without --resume");
        for (const ordered_json& row : document.at("rows")) rows.push_back(row_from_json(row));
    } catch (const ordered_json::exception& error) {
        throw LoadError(path, "", error.what(), "delete it, or run without --resume");
    }
    return rows;
}

HardReport::HardReport(std::string path, int threads, bool resume)
    : m_path(std::move(path)), m_provenance(provenance_json(threads)) {
    if (resume) m_rows = load_rows(m_path);
}

const HardRow* HardReport::find(const std::string& hard_case, const std::string& stepper,
                                int frames_wanted, int starts, const std::string& inputs) const {
    const auto at = std::find_if(m_rows.begin(), m_rows.end(), [&](const HardRow& row) {
        return row.hard_case == hard_case && row.stepper == stepper &&
               row.frames_wanted == frames_wanted && row.starts >= starts && row.inputs == inputs;
    });
    return at == m_rows.end() ? nullptr : &*at;
}

void HardReport::add(const HardRow& row) {
    const auto at = std::find_if(m_rows.begin(), m_rows.end(), [&](const HardRow& other) {
        return other.hard_case == row.hard_case && other.stepper == row.stepper;
    });
    if (at == m_rows.end())
        m_rows.push_back(row);
    else
        *at = row;
    ordered_json document;
    document["provenance"] = m_provenance;
    document["rows"] = ordered_json::array();
    for (const HardRow& one : m_rows) document["rows"].push_back(to_json(one));
    write_text_file(m_path, document.dump(1) + "\n");
}

}  // namespace cloth
