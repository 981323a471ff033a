#pragma once

#include "tests/address_sanitizer.h"

namespace cloth::test {

/// The sanitizers make code ten times as slow. They look for errors of memory and arithmetic, which
/// a few steps show as well as many; how cloth behaves in the long run is tested in optimised
/// builds.
constexpr bool is_sanitized = CLOTH_ADDRESS_SANITIZER;

/// @return  of the steps, worlds or samples of a test, those to run
constexpr int fewer_if_sanitized(int count) {
    return is_sanitized ? (count + 9) / 10 : count;
}

}  // namespace cloth::test
