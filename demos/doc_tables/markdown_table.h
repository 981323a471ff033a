#pragma once

#include <string>
#include <vector>

namespace cloth {

/// A table of a page. Every row has as many cells as the heading.
struct MarkdownTable {
    std::vector<std::string> heading;
    std::vector<std::vector<std::string>> rows;
};

/// The table in GitHub's Markdown, without a newline at its end. @throws ArgumentError for a row of
/// another length than the heading
std::string to_markdown(const MarkdownTable& table);

/// With so many decimals; a dash for NaN.
std::string decimals(double value, int digits);

/// With so many digits that count: 0.0421, 15.5, 420; below 1e-4 as scientific(), a dash for NaN.
std::string significant(double value, int digits);

/// With an exponent, 1.7e-03; a dash for NaN, and 0 is 0.
std::string scientific(double value);

}  // namespace cloth
