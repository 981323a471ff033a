#include "demos/compare/shell_word.h"

namespace cloth {
namespace {

/// Letters that are not ASCII mean nothing to a shell.
bool is_plain(char c) {
    const auto byte = static_cast<unsigned char>(c);
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || byte >= 0x80;
    return letter || (c >= '0' && c <= '9') ||
           std::string("_@%+:,./-").find(c) != std::string::npos;
}

}  // namespace

std::string shell_word(const std::string& text) {
    bool plain = !text.empty();
    for (const char c : text) plain = plain && is_plain(c);
    if (plain) return text;
    std::string word = "'";
    for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return word + "'";
}

}  // namespace cloth
