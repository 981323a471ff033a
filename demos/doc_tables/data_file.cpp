#include "demos/doc_tables/data_file.h"

#include <algorithm>
#include <limits>

#include "data/core/errors.h"
#include "data/core/read_file.h"

namespace cloth {

using Json = nlohmann::ordered_json;

static const char* const measure_again = "measure it again: doc_tables --measure NAME";

void DataRow::refuse(const std::string& problem) const {
    throw LoadError(m_file, m_place, problem, measure_again);
}

const Json& DataRow::at(const std::string& pointer) const {
    const Json::json_pointer place(pointer);
    if (!m_values->contains(place)) refuse("has no " + pointer);
    return m_values->at(place);
}

double DataRow::number(const std::string& pointer) const {
    const Json& value = at(pointer);
    if (value.is_null()) return std::numeric_limits<double>::quiet_NaN();
    if (!value.is_number()) refuse(pointer + " is no number");
    return value.get<double>();
}

std::string DataRow::text(const std::string& pointer) const {
    const Json& value = at(pointer);
    if (value.is_null()) return "";
    if (!value.is_string()) refuse(pointer + " is no text");
    return value.get<std::string>();
}

bool DataRow::truth(const std::string& pointer) const {
    const Json& value = at(pointer);
    if (value.is_null()) return false;
    if (!value.is_boolean()) refuse(pointer + " is neither true nor false");
    return value.get<bool>();
}

bool DataRow::is_null(const std::string& pointer) const {
    return at(pointer).is_null();
}

bool DataRow::has(const std::string& pointer) const {
    return m_values->contains(nlohmann::ordered_json::json_pointer(pointer));
}

DataFile DataFile::load(const std::string& path) {
    Json content = Json::parse(read_file(path), nullptr, /*allow_exceptions=*/false);
    if (!content.is_object()) throw LoadError(path, "", "is not a JSON object", measure_again);
    return {path, std::move(content)};
}

const Json& DataFile::list(const std::string& name) const {
    if (!m_content.contains(name) || !m_content.at(name).is_array())
        throw LoadError(m_path, "", "has no list \"" + name + "\"", measure_again);
    return m_content.at(name);
}

std::vector<DataRow> DataFile::rows(const std::string& name) const {
    std::vector<DataRow> rows;
    for (const Json& values : list(name))
        rows.emplace_back(m_path, name + "[" + std::to_string(rows.size()) + "]", values);
    return rows;
}

DataRow DataFile::row(const std::string& name, const Members& members) const {
    std::string place = name;
    for (const auto& [member, value] : members)
        place += std::string(place == name ? " with " : ", ") + member + " " + value;
    const Json& values = list(name);
    const auto found = std::find_if(values.begin(), values.end(), [&](const Json& one) {
        return std::all_of(members.begin(), members.end(), [&](const auto& wanted) {
            return one.is_object() && one.value(wanted.first, Json()) == wanted.second;
        });
    });
    if (found == values.end()) throw LoadError(m_path, place, "there is none", measure_again);
    return {m_path, place, *found};
}

}  // namespace cloth
