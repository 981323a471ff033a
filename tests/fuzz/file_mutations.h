#pragma once

#include <string>

#include "tests/fuzz/fuzz_random.h"

namespace cloth::test {

/// A file with one to four defects, such as copying, editing and exporting leave behind: flipped
/// bits, missing, repeated and swapped parts, zeros, numbers that are huge, negative, not finite or
/// of the wrong byte order, values of another type, deep nesting, very long lines.
std::string mutated(const std::string& file, Random& random);

}  // namespace cloth::test
