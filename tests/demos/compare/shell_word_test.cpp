#include "demos/compare/shell_word.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace cloth::shell_word_test {

namespace {

/// What a shell makes of a command line's word.
std::string read_by_shell(const std::string& word) {
    std::FILE* const pipe = popen(("printf '[%s]' " + word).c_str(), "r");
    std::string text;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
    pclose(pipe);
    return text;
}

}  // namespace

TEST(ShellWord, IsReadAsItWasMeant) {
    for (const char* text :
         {"", "it's a skirt.obj", "'", "a&b", "a;b", "$HOME", "`ls`", "~", "*", "a\"b", "a\\b",
          "(a)", "#a", "a\nb", "x=1", "Röck+chen & co.obj", "<>|!{}[]?"})
        EXPECT_EQ(read_by_shell(shell_word(text)), "[" + std::string(text) + "]");
}

TEST(ShellWord, IsQuotedOnlyWhereNeeded) {
    for (const char* text : {"out/a_1-2.obj+b.obj", "/usr/bin/x", "01_01", "a,b:c@d%", "Röckchen"})
        EXPECT_EQ(shell_word(text), text);
    EXPECT_EQ(shell_word("a b"), "'a b'");
}

}  // namespace cloth::shell_word_test
