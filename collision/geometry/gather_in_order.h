#pragma once

#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace cloth {

/// Runs work(part, out) for part = 0 .. parts - 1 on several threads and strings the results
/// together in the order of the parts, so that they do not depend on the number of threads.
/// `buffers` keeps its memory from call to call. A few parts are not worth
/// waking threads for.
/// @param threads  0: as many as OpenMP gives
template <typename Item, typename Work>
void gather_in_order(int parts, int threads, std::vector<std::vector<Item>>& buffers,
                     std::vector<Item>& all, const Work& work) {
    if (buffers.size() < static_cast<size_t>(parts)) buffers.resize(static_cast<size_t>(parts));
    [[maybe_unused]] const int workers = threads > 0 ? threads : omp_get_max_threads();
#ifdef _OPENMP  // programs that include this may do without
#pragma omp parallel for schedule(dynamic, 1) num_threads(workers) if (workers > 1 && parts > 3)
#endif
    for (int part = 0; part < parts; ++part) {
        buffers[static_cast<size_t>(part)].clear();
        work(part, buffers[static_cast<size_t>(part)]);
    }
    all.clear();
    for (int part = 0; part < parts; ++part) {
        const std::vector<Item>& found = buffers[static_cast<size_t>(part)];
        all.insert(all.end(), found.begin(), found.end());
    }
}

/// The same for work(item, out) with item = 0 .. count - 1, of which a thread takes many at once.
template <typename Item, typename Work>
void gather_each_in_order(int count, int threads, std::vector<std::vector<Item>>& buffers,
                          std::vector<Item>& all, const Work& work, int items_per_part = 2048) {
    const auto work_part = [&](int part, std::vector<Item>& out) {
        const int end = std::min(count, (part + 1) * items_per_part);
        for (int item = part * items_per_part; item < end; ++item) work(item, out);
    };
    gather_in_order((count + items_per_part - 1) / items_per_part, threads, buffers, all,
                    work_part);
}

}  // namespace cloth
