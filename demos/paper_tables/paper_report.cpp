#include "demos/paper_tables/paper_report.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "data/core/errors.h"
#include "data/core/read_file.h"
#include "data/files/make_folder.h"
#include "demos/provenance/provenance.h"
#include "render/replaced_file.h"

namespace cloth {

using Json = PaperReport::Json;

namespace {

constexpr std::array<const char*, 2> lists = {"rows", "training"};
constexpr std::array<const char*, 3> identity = {"garment", "solver", "network"};

bool same_place(const Json& a, const Json& b) {
    return std::all_of(identity.begin(), identity.end(), [&](const char* member) {
        return a.value(member, Json()) == b.value(member, Json());
    });
}

Json load(const std::string& path) {
    const auto refuse = [&](const std::string& place, const std::string& problem) {
        throw LoadError(path, place, problem, "delete it, or give --again: all is measured anew");
    };
    Json document = Json::parse(read_file(path), nullptr, /*allow_exceptions=*/false);
    if (!document.is_object()) refuse("", "is not a JSON object");
    for (const char* list : lists) {
        if (!document.contains(list)) continue;
        if (!document.at(list).is_array()) refuse(list, "is no list");
        for (const Json& row : document.at(list))
            if (!row.is_object() || !row.contains("key") || !row.at("key").is_string() ||
                !row.contains("commit") || !row.at("commit").is_string())
                refuse(list, "has a row without key and commit");
    }
    return document;
}

}  // namespace

PaperReport::PaperReport(const std::string& folder, int threads, bool again)
    : m_path(folder + "/paper_tables.json") {
    make_folder(folder);
    m_document["provenance"] = provenance_json(threads);
    for (const char* list : lists) m_document[list] = Json::array();
    if (!again && std::filesystem::exists(m_path)) keep_rows_of(load(m_path));
}

void PaperReport::keep_rows_of(const Json& old) {
    for (const char* list : lists) {
        if (!old.contains(list)) continue;
        for (const Json& row : old.at(list))
            if (row.at("commit") == build_commit()) m_document[list].push_back(row);
    }
}

bool PaperReport::has(const std::string& list, const Json& members, const std::string& key) const {
    const Json& rows = m_document.at(list);
    return std::any_of(rows.begin(), rows.end(), [&](const Json& row) {
        return same_place(row, members) && row.at("key") == key;
    });
}

void PaperReport::put(const std::string& list, const Json& row) {
    Json complete = row;
    complete["commit"] = build_commit();
    Json& rows = m_document.at(list);
    const auto at = std::find_if(rows.begin(), rows.end(),
                                 [&](const Json& other) { return same_place(other, row); });
    if (at == rows.end())
        rows.push_back(complete);
    else
        *at = complete;
    save();
}

void PaperReport::arrange(const std::string& list, const std::vector<Json>& places) {
    Json arranged = Json::array(), others = m_document.at(list);
    for (const Json& place : places) {
        const auto at = std::find_if(others.begin(), others.end(),
                                     [&](const Json& row) { return same_place(row, place); });
        if (at == others.end()) continue;
        arranged.push_back(*at);
        others.erase(at);
    }
    for (const Json& row : others) arranged.push_back(row);
    m_document[list] = arranged;
}

void PaperReport::set(const std::string& member, const Json& value) {
    m_document[member] = value;
    save();
}

void PaperReport::save() const {
    write_text_file(m_path, m_document.dump(1) + "\n");
}

}  // namespace cloth
