// doc_tables: the tables of the documentation, made from committed reports. See --help.

#include <cstdio>
#include <filesystem>

#include "data/core/errors.h"
#include "data/core/read_file.h"
#include "demos/compare/arguments.h"
#include "demos/doc_tables/markdown_page.h"
#include "demos/doc_tables/measure.h"
#include "demos/doc_tables/registry.h"
#include "render/replaced_file.h"

using namespace cloth;

namespace {

const char* const usage =
    "doc_tables: the tables of the documentation, made from committed reports\n"
    "  (nothing)       write the tables of all pages anew\n"
    "  --check         change nothing; fail where a page and the data differ\n"
    "  --list          tables, their files, and the commands that measure them\n"
    "  --measure NAME  run the command of this table or file again, then write all tables\n"
    "  --root DIR      of the sources (default: the current folder)\n"
    "  --help          this text\n"
    "A page has a table between the lines <!-- table: NAME --> and <!-- end of table -->.\n";

struct Options {
    std::string root = ".", measured;
    bool check = false, list = false;
};

Options parse_options(const std::vector<std::string>& arguments) {
    Options options;
    for (size_t i = 0; i < arguments.size(); ++i) {
        const std::string& option = arguments[i];
        const bool has_value = i + 1 < arguments.size();
        if (option == "--help" || option == "-h") throw HelpText(usage);
        if (option == "--check")
            options.check = true;
        else if (option == "--list")
            options.list = true;
        else if (option == "--measure" && has_value)
            options.measured = arguments[++i];
        else if (option == "--root" && has_value)
            options.root = arguments[++i];
        else
            throw UsageError(usage);
    }
    return options;
}

void list_tables(const Registry& registry) {
    for (const DocTable& table : registry.tables) {
        std::printf("%s\n", table.name.c_str());
        for (const std::string& name : table.data)
            std::printf("    %s\n    %s\n", registry.data_set(name).file.c_str(),
                        registry.data_set(name).command.c_str());
    }
}

/// The data sets of the table of this name, or the one of this name.
std::vector<std::string> data_of(const Registry& registry, const std::string& name) {
    const DocTable* table = registry.find_table(name);
    return table ? table->data : std::vector<std::string>{registry.data_set(name).name};
}

/// Writes or checks the pages. @return how many differ
int update_pages(const Registry& registry, const Options& options) {
    int different = 0, tables = 0;
    for (const std::string& page : markdown_pages(options.root)) {
        const std::string text = read_file(page);
        const std::string wanted =
            with_tables(page, text, [&](const std::string& name) -> std::optional<std::string> {
                const DocTable* table = registry.find_table(name);
                if (!table) return std::nullopt;
                ++tables;
                return table_text(registry, *table, options.root, page);
            });
        if (text == wanted) continue;
        ++different;
        if (options.check)
            std::fprintf(stderr, "%s\n", first_difference(page, text, wanted).c_str());
        else
            write_text_file(page, wanted);
    }
    if (tables == 0)
        throw LoadError(options.root, "", "no page under it has a table",
                        "give the folder of the sources: --root DIR");
    return different;
}

int run(const Options& options) {
    const Registry& registry = doc_registry();
    if (options.list) {
        list_tables(registry);
        return 0;
    }
    // build/release/demos/doc_tables, and the other programs beside it
    const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe");
    if (!options.measured.empty())
        for (const std::string& name : data_of(registry, options.measured))
            measure(registry.data_set(name), options.root,
                    own.parent_path().parent_path().string());
    const int different = update_pages(registry, options);
    return options.check && different > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        Options options = parse_options(std::vector<std::string>(argv + 1, argv + argc));
        options.root = std::filesystem::canonical(options.root).string();
        return run(options);
    } catch (const HelpText& help) {
        std::printf("%s", help.what());
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
