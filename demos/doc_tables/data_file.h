#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace cloth {

/// An object in a data file. What it has not, or has of another type, is an error that names file,
/// object and member.
class DataRow {
 public:
    /// @param values  must outlive the row
    DataRow(std::string file, std::string place, const nlohmann::ordered_json& values)
        : m_file(std::move(file)), m_place(std::move(place)), m_values(&values) {}

    /// @param pointer  such as "/rollout/rmse_mm"; a number, or NaN for null
    double number(const std::string& pointer) const;
    /// A text; empty for null.
    std::string text(const std::string& pointer) const;
    /// True or false; false for null.
    bool truth(const std::string& pointer) const;
    bool is_null(const std::string& pointer) const;
    bool has(const std::string& pointer) const;

 private:
    const nlohmann::ordered_json& at(const std::string& pointer) const;
    [[noreturn]] void refuse(const std::string& problem) const;

    std::string m_file, m_place;
    const nlohmann::ordered_json* m_values;
};

/// A committed report.
class DataFile {
 public:
    using Members = std::vector<std::pair<std::string, std::string>>;

    DataFile(std::string path, nlohmann::ordered_json content)
        : m_path(std::move(path)), m_content(std::move(content)) {}
    /// @throws LoadError if there is no such file or it is not JSON
    static DataFile load(const std::string& path);

    const std::string& path() const { return m_path; }
    const nlohmann::ordered_json& content() const { return m_content; }

    /// The objects of one of the file's lists. @throws LoadError if there is no such list
    std::vector<DataRow> rows(const std::string& list) const;
    /// The first of them with these texts as members. @throws LoadError if there is none
    DataRow row(const std::string& list, const Members& members) const;

 private:
    const nlohmann::ordered_json& list(const std::string& name) const;

    std::string m_path;
    nlohmann::ordered_json m_content;
};

}  // namespace cloth
