#pragma once

#include <vector>

namespace cloth {

/// Binds this process to as many of its cores as it shall have threads, and each OpenMP thread to
/// one of them; sets OpenMP's number of threads. Call it before other work.
/// @param threads  0: as many as there are cores that the process may use
/// @return the cores, one per thread
/// @throws UsageError if there are fewer cores than threads
std::vector<int> pin_threads(int threads);

}  // namespace cloth
