#pragma once

#include <string>

namespace cloth {

/// Text of a file as it may stand in a message: control characters, which would end or garble it,
/// become '?', and what is long is cut.
inline std::string printable(std::string text) {
    constexpr size_t longest = 500;
    if (text.size() > longest) text = text.substr(0, longest) + "...";
    for (char& c : text)
        if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
    return text;
}

}  // namespace cloth
