// The guides: their code is compiled, their links and commands lead somewhere, the README is short.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace cloth::docs_test {

namespace fs = std::filesystem;

namespace {

const fs::path root = CLOTH_SOURCE_DIR;

std::string read(const fs::path& path) {
    std::stringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

/// Lines without what stands before and after them, so that a block may be indented less.
std::string unindented(const std::string& text) {
    std::string result;
    for (const std::string& line : lines_of(text)) {
        const size_t first = line.find_first_not_of(' ');
        if (first != std::string::npos) result += line.substr(first) + "\n";
    }
    return result;
}

std::vector<fs::path> pages() {
    std::vector<fs::path> found;
    for (const char* top : {"bullet_ext", "collision", "data", "demos", "gnn", "render", "tests"})
        for (const auto& entry : fs::recursive_directory_iterator(root / top))
            if (entry.path().extension() == ".md") found.push_back(entry.path());
    for (const char* page : {"README.md", "CONTRIBUTING.md", "CHANGELOG.md"})
        found.push_back(root / page);
    std::sort(found.begin(), found.end());
    return found;
}

struct CodeBlock {
    std::string from;  ///< file named in the line before; "" without one
    std::string text;
    int line = 0;
};

std::vector<CodeBlock> code_blocks(const fs::path& page) {
    static const std::regex marker("<!-- from: (\\S+) -->");
    std::vector<CodeBlock> blocks;
    const std::vector<std::string> lines = lines_of(read(page));
    for (size_t i = 0; i < lines.size(); ++i) {
        if (lines[i].rfind("```cpp", 0) != 0) continue;
        CodeBlock block;
        block.line = static_cast<int>(i) + 1;
        std::smatch match;
        if (i > 0 && std::regex_match(lines[i - 1], match, marker)) block.from = match[1];
        for (++i; i < lines.size() && lines[i] != "```"; ++i) block.text += lines[i] + "\n";
        blocks.push_back(block);
    }
    return blocks;
}

/// The name by which GitHub links to a heading.
std::string anchor_of(const std::string& heading) {
    std::string anchor;
    for (const char c : heading.substr(heading.find_first_not_of("# "))) {
        if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_')
            anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        else if (c == ' ')
            anchor += '-';
    }
    return anchor;
}

bool has_anchor(const fs::path& page, const std::string& anchor) {
    for (const std::string& line : lines_of(read(page)))
        if (line.rfind("#", 0) == 0 && anchor_of(line) == anchor) return true;
    return false;
}

/// All first groups of `pattern` in a page.
std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
    const std::regex expression(pattern);
    std::vector<std::string> found;
    for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it)
        found.push_back((*it)[1]);
    return found;
}

}  // namespace

TEST(Docs, CodeIsThatOfACompiledFile) {
    int count = 0;
    for (const fs::path& page : pages())
        for (const CodeBlock& block : code_blocks(page)) {
            ++count;
            const std::string place = page.string() + ":" + std::to_string(block.line);
            ASSERT_FALSE(block.from.empty())
                << place << ": write <!-- from: FILE --> in the line before the block";
            const std::string source = unindented(read(root / block.from));
            EXPECT_NE(source.find(unindented(block.text)), std::string::npos)
                << place << ": this code is not in " << block.from;
        }
    EXPECT_GE(count, 10);
}

TEST(Docs, TheReadmeShowsTheWholeSmallestProgram) {
    EXPECT_NE(
        read(root / "README.md").find("```cpp\n" + read(root / "demos/hello_cloth.cpp") + "```"),
        std::string::npos)
        << "copy demos/hello_cloth.cpp into README.md";
}

TEST(Docs, TheReadmeIsShort) {
    EXPECT_LE(lines_of(read(root / "README.md")).size(), 150u);
}

TEST(Docs, EveryFolderHasAPage) {
    for (const char* folder : {"bullet_ext", "collision", "data", "data/assets", "demos", "gnn",
                               "gnn/model", "gnn/train", "render", "tests"})
        EXPECT_TRUE(fs::exists(root / folder / "README.md")) << folder;
}

TEST(Docs, LinksLeadSomewhere) {
    for (const fs::path& page : pages())
        for (const std::string& link : matches(read(page), "\\]\\(([^)\\s]+)\\)")) {
            if (link.rfind("http", 0) == 0) continue;
            const size_t hash = link.find('#');
            const std::string file = link.substr(0, hash);
            const fs::path target = file.empty() ? page : page.parent_path() / file;
            EXPECT_TRUE(fs::exists(target)) << page << " links to " << link;
            if (hash == std::string::npos || !fs::exists(target)) continue;
            EXPECT_TRUE(has_anchor(target, link.substr(hash + 1))) << page << " links to " << link;
        }
}

TEST(Docs, CommandsNameProgramsThatThereAre) {
    for (const fs::path& page : pages())
        for (const std::string& program : matches(read(page), "build/[a-z]+/demos/([a-z_]+)"))
            EXPECT_TRUE(fs::exists(root / "demos" / (program + ".cpp")) ||
                        fs::exists(root / "demos" / program / "main.cpp"))
                << page << " names " << program;
}

TEST(Docs, CommandsNamePresetsThatThereAre) {
    const std::string presets = read(root / "CMakePresets.json");
    for (const fs::path& page : pages())
        for (const std::string& preset : matches(read(page), "cmake --preset ([a-z]+)"))
            EXPECT_NE(presets.find("\"name\": \"" + preset + "\""), std::string::npos)
                << page << " names " << preset;
}

// Who reads a guide from its beginning has built what it runs.
TEST(Docs, GuidesBuildAPresetBeforeTheyRunItsPrograms) {
    for (const char* page : {"README.md", "demos/README.md", "data/README.md"}) {
        const std::string text = read(root / page);
        for (const std::string& preset : matches(text, "\n    build/([a-z]+)/demos/"))
            EXPECT_LT(text.find("cmake --build --preset " + preset),
                      text.find("\n    build/" + preset + "/demos/"))
                << page << ": " << preset;
    }
}

}  // namespace cloth::docs_test
