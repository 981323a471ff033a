#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace cloth {

/// The text that belongs between the markers of a table; nothing if there is no table of this name.
using TableText = std::function<std::optional<std::string>(const std::string& name)>;

/// The page with all of its tables made anew. A table stands between two lines:
///
///     <!-- table: NAME -->
///     (whatever is here is replaced)
///     <!-- end of table -->
///
/// Markers in fenced code are text like any other.
/// @param page  its path, for messages
/// @throws LoadError naming page, line and remedy for a table that is unknown or not closed
std::string with_tables(const std::string& page, const std::string& text, const TableText& table);

/// What is wrong with a page whose text should be `wanted`: place and both lines; empty if nothing.
std::string first_difference(const std::string& page, const std::string& text,
                             const std::string& wanted);

/// Paths of the pages (*.md) under a folder, sorted. Hidden folders and `build` and `out` do not
/// count.
std::vector<std::string> markdown_pages(const std::string& folder);

}  // namespace cloth
