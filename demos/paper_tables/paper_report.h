#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace cloth {

/// paper_tables.json: what is measured, row by row. A row is an object that has "key", a text of
/// all that its figures depend on. Saved whole or not at all.
///
///     PaperReport report(folder, threads, again);
///     if (!report.has("rows", {{"garment", "tshirt"}, {"solver", "fast+0"}}, key))
///         report.put("rows", measured);  // and saves
class PaperReport {
 public:
    using Json = nlohmann::ordered_json;

    /// Goes on with the file in the folder, if there is one. Rows of another commit are left out.
    /// @param again  begins afresh
    /// @throws LoadError naming the file if it is damaged
    PaperReport(const std::string& folder, int threads, bool again);

    /// Whether a list has a row with these members and this key.
    bool has(const std::string& list, const Json& members, const std::string& key) const;

    /// Adds the row to a list and saves. It takes the place of one with the same garment, solver
    /// and network.
    void put(const std::string& list, const Json& row);

    /// Brings the rows of a list into the order of these places, {garment, solver} each; others
    /// follow. It does not save.
    void arrange(const std::string& list, const std::vector<Json>& places);

    /// Sets a member of the document that is no list of rows, and saves.
    void set(const std::string& member, const Json& value);

    /// Writes the file. @throws LoadError if that is not possible
    void save() const;

    const Json& document() const { return m_document; }
    const std::string& path() const { return m_path; }

 private:
    void keep_rows_of(const Json& old);

    std::string m_path;
    Json m_document;
};

}  // namespace cloth
