#include "demos/doc_tables/markdown_page.h"

#include <algorithm>
#include <filesystem>

#include "data/core/errors.h"

namespace cloth {

namespace {

constexpr const char* end_marker = "<!-- end of table -->";

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    size_t begin = 0;
    for (size_t end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1)
        lines.push_back(text.substr(begin, end - begin));
    if (begin < text.size()) lines.push_back(text.substr(begin));
    return lines;
}

/// NAME if the line is <!-- table: NAME -->.
std::optional<std::string> table_named_in(const std::string& line) {
    const std::string before = "<!-- table: ", after = " -->";
    if (line.size() <= before.size() + after.size() || line.rfind(before, 0) != 0 ||
        line.compare(line.size() - after.size(), after.size(), after) != 0)
        return std::nullopt;
    return line.substr(before.size(), line.size() - before.size() - after.size());
}

bool is_fence(const std::string& line) {
    return line.rfind("```", 0) == 0 || line.rfind("~~~", 0) == 0;
}

struct MarkedTable {
    std::string name;
    size_t begin = 0, end = 0;  ///< lines of its two markers
};

[[noreturn]] void refuse(const std::string& page, size_t line, const std::string& problem,
                         const std::string& remedy) {
    throw LoadError(page, "line " + std::to_string(line + 1), problem, remedy);
}

std::vector<MarkedTable> marked_tables(const std::string& page,
                                       const std::vector<std::string>& lines) {
    std::vector<MarkedTable> tables;
    bool code = false, open = false;
    const auto refuse_open = [&] {
        refuse(page, tables.back().begin, "table " + tables.back().name + " is not closed",
               "put " + std::string(end_marker) + " on a line of its own after it");
    };
    for (size_t k = 0; k < lines.size(); ++k) {
        if (!open && is_fence(lines[k])) code = !code;
        if (code) continue;
        if (const auto name = table_named_in(lines[k])) {
            if (open) refuse_open();
            tables.push_back({*name, k, k});
            open = true;
        } else if (lines[k] == end_marker) {
            if (!open)
                refuse(page, k, "a table ends that has not begun",
                       "put <!-- table: NAME --> on a line of its own before it");
            tables.back().end = k;
            open = false;
        }
    }
    if (open) refuse_open();
    return tables;
}

}  // namespace

std::string with_tables(const std::string& page, const std::string& text, const TableText& table) {
    const std::vector<std::string> lines = lines_of(text);
    std::string made;
    size_t copied = 0;
    const auto copy_to = [&](size_t end) {
        for (; copied < end; ++copied) made += lines[copied] + "\n";
    };
    for (const MarkedTable& marked : marked_tables(page, lines)) {
        const std::optional<std::string> content = table(marked.name);
        if (!content)
            refuse(page, marked.begin, "there is no table " + marked.name,
                   "choose one that doc_tables --list names");
        copy_to(marked.begin + 1);
        made += "\n" + *content + "\n\n";
        copied = marked.end;
    }
    copy_to(lines.size());
    return made;
}

std::string first_difference(const std::string& page, const std::string& text,
                             const std::string& wanted) {
    const std::vector<std::string> lines = lines_of(text), others = lines_of(wanted);
    const auto [at, other] =
        std::mismatch(lines.begin(), lines.end(), others.begin(), others.end());
    if (at == lines.end() && other == others.end()) return "";
    std::string table;
    for (auto line = lines.begin(); line != at; ++line)
        if (const auto name = table_named_in(*line)) table = *name;
    const auto quoted = [](auto line, auto end) {
        return line == end ? "at its end" : "\"" + *line + "\"";
    };
    return page + ", line " + std::to_string(at - lines.begin() + 1) + ", table " + table +
           ": the page is " + quoted(at, lines.end()) + ", the data say " +
           quoted(other, others.end()) + ". Remedy: run build/release/demos/doc_tables";
}

std::vector<std::string> markdown_pages(const std::string& folder) {
    std::vector<std::string> pages;
    using Files = std::filesystem::recursive_directory_iterator;
    for (Files file(folder); file != Files(); ++file) {
        const std::string name = file->path().filename().string();
        if (file->is_directory()) {
            if (name[0] == '.' || name == "build" || name == "out")
                file.disable_recursion_pending();
        } else if (file->path().extension() == ".md") {
            pages.push_back(file->path().string());
        }
    }
    std::sort(pages.begin(), pages.end());
    return pages;
}

}  // namespace cloth
