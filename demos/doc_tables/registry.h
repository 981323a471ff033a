#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "demos/doc_tables/data_file.h"
#include "demos/doc_tables/markdown_table.h"

namespace cloth {

/// A committed report, and how it is measured. Paths are relative to the root of the sources.
struct DataSet {
    std::string name;
    std::string file;  ///< the committed one
    /// A shell command, from the root. It finds programs in build/release, and an empty folder
    /// where it says OUT.
    std::string command;
    std::string product;  ///< file in OUT that it writes
    /// What is committed of the product; empty: all of it.
    std::function<nlohmann::ordered_json(const nlohmann::ordered_json&)> tidy;
    /// Pictures that the command makes as well: file in OUT, committed file.
    std::vector<std::pair<std::string, std::string>> pictures;
};

/// A table of the documentation.
struct DocTable {
    std::string name;
    std::vector<std::string> data;  ///< names of its data sets
    /// Makes it from the files of the data sets, in their order.
    std::function<MarkdownTable(const std::vector<DataFile>&)> make;
};

struct Registry {
    std::vector<DataSet> data_sets;
    std::vector<DocTable> tables;

    const DocTable* find_table(const std::string& name) const;  ///< null: there is none
    /// @throws ArgumentError if there is none of this name
    const DataSet& data_set(const std::string& name) const;
};

/// All tables of this project's documentation.
const Registry& doc_registry();

/// A table and where its figures are from, as a page shows it.
/// @param root  of the sources
/// @param page  path of the page, for links
/// @throws LoadError naming file, place and remedy if the data have not what the table shows
std::string table_text(const Registry& registry, const DocTable& table, const std::string& root,
                       const std::string& page);

}  // namespace cloth
