#include "demos/doc_tables/markdown_table.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "data/core/errors.h"

namespace cloth {

namespace {

constexpr const char* dash = "–";

std::string formatted(const char* format, int digits, double value) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), format, digits, value);
    return text.data();
}

std::string line_of(const std::vector<std::string>& cells) {
    std::string line = "|";
    for (const std::string& cell : cells) {
        line += " ";
        for (const char c : cell) line += c == '|' ? "\\|" : std::string(1, c);
        line += " |";
    }
    return line;
}

}  // namespace

std::string to_markdown(const MarkdownTable& table) {
    std::string text = line_of(table.heading) + "\n|";
    for (size_t k = 0; k < table.heading.size(); ++k) text += "---|";
    for (const auto& row : table.rows) {
        if (row.size() != table.heading.size())
            throw ArgumentError("row of a table", "has " + std::to_string(row.size()) + " cells",
                                "give " + std::to_string(table.heading.size()));
        text += "\n" + line_of(row);
    }
    return text;
}

std::string decimals(double value, int digits) {
    if (std::isnan(value)) return dash;
    const std::string text = formatted("%.*f", digits, value);
    return std::strtod(text.c_str(), nullptr) == 0.0 && text[0] == '-' ? text.substr(1) : text;
}

std::string significant(double value, int digits) {
    if (std::isnan(value)) return dash;
    if (value == 0.0) return "0";
    if (std::abs(value) < 1e-4) return scientific(value);
    // First rounded, so that 9.96 has the exponent of 10.
    const double rounded = std::strtod(formatted("%.*e", digits - 1, value).c_str(), nullptr);
    const int exponent = static_cast<int>(std::floor(std::log10(std::abs(rounded))));
    return decimals(rounded, std::max(0, digits - 1 - exponent));
}

std::string scientific(double value) {
    if (std::isnan(value)) return dash;
    return value == 0.0 ? "0" : formatted("%.*e", 1, value);
}

}  // namespace cloth
