#include "demos/doc_tables/registry.h"

#include <algorithm>
#include <filesystem>

#include "data/core/errors.h"

namespace cloth {

namespace {

template <typename Named>
const Named* found(const std::vector<Named>& all, const std::string& name) {
    const auto at =
        std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
    return at == all.end() ? nullptr : &*at;
}

/// "threads: 2" and the like; not recorded where it is null.
std::string said(const std::string& what, const nlohmann::ordered_json& value) {
    if (value.is_null()) return what + " not recorded";
    return what + " " + (value.is_string() ? value.get<std::string>() : value.dump());
}

/// Where the figures of a file are from, in a sentence.
std::string origin(const DataFile& file) {
    const nlohmann::ordered_json& content = file.content();
    const nlohmann::ordered_json provenance = content.value("provenance", nlohmann::ordered_json());
    for (const char* member : {"commit", "machine", "threads", "date"})
        if (!provenance.contains(member))
            throw LoadError(file.path(), "provenance", "has no " + std::string(member),
                            "measure it again, or write null for what nobody knows");
    std::string text = said("commit", provenance.at("commit"));
    if (provenance.contains("committed_in"))
        text += " (the file is of " + provenance.at("committed_in").get<std::string>() + ")";
    text += "; " + said("machine", provenance.at("machine")) + "; " +
            said("threads", provenance.at("threads")) + "; " + said("date", provenance.at("date")) +
            ".";
    if (provenance.contains("note")) text += " " + provenance.at("note").get<std::string>();
    return text;
}

std::string link_to(const std::string& file, const std::string& root, const std::string& page) {
    const std::filesystem::path target(file), from = std::filesystem::path(page).parent_path();
    const std::string path =
        (root / target).lexically_normal().lexically_relative(from.lexically_normal());
    return "[" + target.filename().string() + "](" + path + ")";
}

}  // namespace

const DocTable* Registry::find_table(const std::string& name) const {
    return found(tables, name);
}

const DataSet& Registry::data_set(const std::string& name) const {
    if (const DataSet* set = found(data_sets, name)) return *set;
    throw ArgumentError("data set " + name, "is unknown", "choose one of doc_tables --list");
}

std::string table_text(const Registry& registry, const DocTable& table, const std::string& root,
                       const std::string& page) {
    std::vector<DataFile> files;
    std::string origins;
    for (const std::string& name : table.data) {
        const DataSet& set = registry.data_set(name);
        files.push_back(DataFile::load((std::filesystem::path(root) / set.file).string()));
        origins += "\n\nMeasured: " + link_to(set.file, root, page) + ", " + origin(files.back()) +
                   " Again: `build/release/demos/doc_tables --measure " + name + "`.";
    }
    return to_markdown(table.make(files)) + origins;
}

}  // namespace cloth
