#pragma once

#include <string>

namespace cloth {

/// The text as one word of a POSIX shell's command line, for commands that people copy: as it is
/// where that does, else between apostrophes.
std::string shell_word(const std::string& text);

}  // namespace cloth
