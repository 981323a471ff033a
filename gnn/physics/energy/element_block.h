#pragma once

#include <algorithm>

namespace cloth {

/// Work space for a run of elements (triangles, hinges) laid out coordinate by coordinate, so that
/// the compiler vectorises the arithmetic over elements. Lives on the stack: no allocation per call
/// and no shared state. Sums run in element order, so equal inputs give equal bits.
///
/// @tparam corners  vertices per element
template <int corners>
struct ElementBlock {
    static constexpr int size = 64;  ///< elements per run: the block stays in the first-level cache

    /// First element of a part of `count` elements: parts begin with a run.
    static int begin_of(int part, int parts, int count) {
        const int runs = (count + size - 1) / size;
        return std::min(count, runs * part / parts * size);
    }

    alignas(32) double x[3 * corners][size];  ///< positions (m), then the gradient (N) in place
    alignas(32) double energy[size];          ///< (J)

    /// Reads the corners of elements first .. first + count - 1.
    /// @param points   |V| x 3, row-major
    /// @param indices  |elements| x corners, row-major
    void gather(const double* points, const int* indices, int first, int count) {
        for (int e = 0; e < count; ++e)
            for (int corner = 0; corner < corners; ++corner) {
                const double* p = points + 3 * indices[corners * (first + e) + corner];
                for (int axis = 0; axis < 3; ++axis) x[3 * corner + axis][e] = p[axis];
            }
    }

    /// Adds the gradients, which the kernel left in `x`, to the vertices.
    void scatter(double* gradient, const int* indices, int first, int count) const {
        for (int e = 0; e < count; ++e)
            for (int corner = 0; corner < corners; ++corner) {
                double* g = gradient + 3 * indices[corners * (first + e) + corner];
                for (int axis = 0; axis < 3; ++axis) g[axis] += x[3 * corner + axis][e];
            }
    }

    double total_energy(int count) const {
        double total = 0.0;
        for (int e = 0; e < count; ++e) total += energy[e];
        return total;
    }
};

}  // namespace cloth
