#include "demos/doc_tables/measure.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "data/core/errors.h"
#include "data/core/read_file.h"
#include "render/replaced_file.h"

namespace cloth {

namespace {

std::string replaced(std::string text, const std::string& part, const std::string& by) {
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + by.size()))
        text.replace(at, part.size(), by);
    return text;
}

/// For the shell.
std::string quoted(const std::string& text) {
    return "'" + replaced(text, "'", "'\\''") + "'";
}

}  // namespace

void measure(const DataSet& set, const std::string& root, const std::string& build) {
    const std::filesystem::path base(root), out = base / "out/doc_tables" / set.name;
    std::filesystem::remove_all(out);  // nothing of an earlier run may get into the figures
    std::filesystem::create_directories(out);
    const std::string command = replaced(replaced(set.command, "build/release", quoted(build)),
                                         "OUT", quoted(out.string()));
    std::printf("%s\n", command.c_str());
    std::fflush(stdout);
    const int status = std::system(("cd " + quoted(root) + " && " + command).c_str());
    if (status != 0)
        throw LoadError("command of " + set.name, "", "failed (" + command + ")",
                        "see above; build the programs first: cmake --build --preset release");
    const DataFile product = DataFile::load((out / set.product).string());
    const nlohmann::ordered_json content =
        set.tidy ? set.tidy(product.content()) : product.content();
    for (const auto& [made, committed] : set.pictures)
        write_text_file((base / committed).string(), read_file((out / made).string()));
    write_text_file((base / set.file).string(), content.dump(1) + "\n");
}

}  // namespace cloth
