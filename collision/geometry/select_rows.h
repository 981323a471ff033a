#pragma once

#include <cstddef>
#include <vector>

namespace cloth {

/// Puts those of first .. last - 1 for which is_wanted(i) is true into `rows`, ascending, whatever
/// the number of threads. is_wanted() is called once for each, and may write what belongs to i.
/// @param enough  as many are worth waking threads for
/// @param wanted  scratch memory: keeps its size from call to call
template <class IsWanted>
void select_rows(int first, int last, [[maybe_unused]] int enough, std::vector<char>& wanted,
                 std::vector<int>& rows, const IsWanted& is_wanted) {
    const auto count = static_cast<size_t>(last - first);
    if (wanted.size() < count) wanted.resize(count);
#ifdef _OPENMP
#pragma omp parallel for if (last - first >= enough)
#endif
    for (int i = first; i < last; ++i) wanted[static_cast<size_t>(i - first)] = is_wanted(i);
    rows.resize(count);
    size_t found = 0;
    for (int i = first; i < last; ++i) {  // no branch: which ones pass is unpredictable
        rows[found] = i;
        found += static_cast<size_t>(wanted[static_cast<size_t>(i - first)]);
    }
    rows.resize(found);
}

/// The same among `rows`, of which those that are not wanted are dropped.
template <class IsWanted>
void keep_rows([[maybe_unused]] int enough, std::vector<char>& wanted, std::vector<int>& rows,
               const IsWanted& is_wanted) {
    const size_t count = rows.size();
    if (wanted.size() < count) wanted.resize(count);
    const int last = static_cast<int>(count);
#ifdef _OPENMP
#pragma omp parallel for if (last >= enough)
#endif
    for (int k = 0; k < last; ++k) {
        const auto at = static_cast<size_t>(k);
        wanted[at] = is_wanted(rows[at]);
    }
    size_t found = 0;
    for (size_t k = 0; k < count; ++k) {
        rows[found] = rows[k];
        found += static_cast<size_t>(wanted[k]);
    }
    rows.resize(found);
}

}  // namespace cloth
