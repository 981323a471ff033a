#pragma once

#include <cstddef>

namespace cloth {

/// The threads of a parallel region as they share out the two halves and the top of a
/// SupernodalCholesky. One thread does all three parts, two a half each, and the first the top.
///
///     #pragma omp parallel num_threads(2)
///     {
///         const Crew crew;
///         crew.for_parts([&](size_t part) { ... });
///         Crew::wait();  // for the other's parts
///     }
class Crew {
 public:
    static constexpr size_t top = 2;  ///< the part after the halves, which are 0 and 1
    static constexpr size_t parts = 3;

    /// Of the parallel region around it.
    Crew();

    bool leads() const { return m_first == 0; }
    template <class Work>
    void for_halves(const Work& work) const {
        for (size_t half = m_first; half < top; half += m_count) work(half);
    }
    template <class Work>
    void for_parts(const Work& work) const {
        for_halves(work);
        if (leads()) work(top);
    }
    static void wait();

 private:
    size_t m_first, m_count;
};

}  // namespace cloth
