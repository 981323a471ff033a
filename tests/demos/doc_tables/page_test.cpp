// Markers of tables in a page.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "data/core/errors.h"
#include "demos/doc_tables/markdown_page.h"

namespace cloth::page_test {

namespace {

std::optional<std::string> shoes(const std::string& name) {
    if (name != "shoes") return std::nullopt;
    return "| shoes |\n|---|\n| 2 |";
}

const std::string old_page =
    "# Shop\n\n<!-- table: shoes -->\n\n| shoes |\n|---|\n| 1 |\n\n<!-- end of table -->\nThe "
    "end.\n";
const std::string new_page =
    "# Shop\n\n<!-- table: shoes -->\n\n| shoes |\n|---|\n| 2 |\n\n<!-- end of table -->\nThe "
    "end.\n";

std::string refusal(const std::string& text) {
    try {
        with_tables("shop.md", text, shoes);
    } catch (const LoadError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST(Page, TablesAreMadeAnewAndNothingElse) {
    EXPECT_EQ(with_tables("shop.md", old_page, shoes), new_page);
    EXPECT_EQ(with_tables("shop.md", new_page, shoes), new_page) << "twice is as once";
    const std::string bare = "<!-- table: shoes -->\n<!-- end of table -->\n";
    EXPECT_EQ(with_tables("shop.md", bare, shoes),
              "<!-- table: shoes -->\n\n| shoes |\n|---|\n| 2 |\n\n<!-- end of table -->\n");
    EXPECT_EQ(with_tables("shop.md", "no table\n", shoes), "no table\n");
}

TEST(Page, MarkersInCodeAreText) {
    const std::string fenced = "```\n<!-- table: hats -->\n```\n    <!-- table: hats -->\n";
    EXPECT_EQ(with_tables("shop.md", fenced, shoes), fenced);
}

TEST(Page, WhatIsWrongWithMarkersIsSaidWithTheLine) {
    EXPECT_EQ(refusal("\n<!-- table: hats -->\n<!-- end of table -->\n"),
              "shop.md, line 2: there is no table hats. Remedy: choose one that doc_tables --list "
              "names");
    const std::string not_closed =
        "shop.md, line 1: table shoes is not closed. Remedy: put <!-- end of table --> on a line "
        "of its own after it";
    EXPECT_EQ(refusal("<!-- table: shoes -->\n"), not_closed);
    EXPECT_EQ(refusal("<!-- table: shoes -->\n<!-- table: shoes -->\n<!-- end of table -->\n"),
              not_closed);
    EXPECT_EQ(refusal("\n\n<!-- end of table -->\n"),
              "shop.md, line 3: a table ends that has not begun. Remedy: put <!-- table: NAME --> "
              "on a line of its own before it");
}

TEST(Page, TheFirstDifferenceIsNamed) {
    EXPECT_EQ(first_difference("shop.md", new_page, new_page), "");
    EXPECT_EQ(first_difference("shop.md", old_page, new_page),
              "shop.md, line 7, table shoes: the page is \"| 1 |\", the data say \"| 2 |\". "
              "Remedy: run build/release/demos/doc_tables");
}

TEST(Page, PagesAreFoundButNotThoseOfBuilds) {
    namespace fs = std::filesystem;
    const fs::path root = fs::path(::testing::TempDir()) / "doc_tables_pages";
    fs::remove_all(root);
    for (const char* folder : {"demos", "build/release", "out", ".git"}) {
        fs::create_directories(root / folder);
        std::ofstream(root / folder / "page.md") << "x\n";
    }
    std::ofstream(root / "README.md") << "x\n";
    std::ofstream(root / "demos/code.cpp") << "x\n";
    EXPECT_EQ(markdown_pages(root.string()),
              (std::vector<std::string>{(root / "README.md").string(),
                                        (root / "demos/page.md").string()}));
}

}  // namespace cloth::page_test
