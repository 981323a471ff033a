#pragma once

#include <string>

namespace cloth {

/// The bytes of a file. (Streams do not do: they open folders, and throw where they are read.)
/// @throws LoadError if there is no such file, it is a folder or it cannot be read
std::string read_file(const std::string& path);

/// The same without the byte order mark that some editors put before text in UTF-8.
/// @throws LoadError as read_file()
std::string read_text_file(const std::string& path);

}  // namespace cloth
