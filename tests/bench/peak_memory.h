#pragma once

#include <malloc.h>

#include <functional>

#include "demos/compare/memory.h"

namespace cloth::test {

/// How much the process grew by at most while `work` ran (MB of 1e6 bytes).
inline double peak_memory_of(const std::function<void()>& work) {
    malloc_trim(0);
    const double before = resident_memory_mb();
    reset_peak_memory();
    work();
    return peak_memory_mb() - before;
}

}  // namespace cloth::test
