#pragma once

#include <algorithm>
#include <array>
#include <cstring>

#include "gnn/physics/energy/lanes.h"

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
        const int* corner_of = indices + corners * first;
        int e = 0;
        for (; e + 4 <= count; e += 4)
            for (int corner = 0; corner < corners; ++corner) {
                const auto row = [&](int k) {
                    return points + 3 * corner_of[corners * (e + k) + corner];
                };
                read_four({row(0), row(1), row(2), row(3)}, &x[3 * corner], e);
            }
        for (; e < count; ++e)
            for (int corner = 0; corner < corners; ++corner) {
                const double* p = points + 3 * corner_of[corners * e + corner];
                for (int axis = 0; axis < 3; ++axis) x[3 * corner + axis][e] = p[axis];
            }
    }

    /// Adds the gradients, which the kernel left in `x`, to the vertices.
    void scatter(double* gradient, const int* indices, int first, int count) const {
        const int* corner_of = indices + corners * first;
        int e = 0;
        for (; e + 4 <= count; e += 4) {
            DoubleLanes rows[corners][4];  // a spare lane behind each gradient
            for (int corner = 0; corner < corners; ++corner) {
                for (int axis = 0; axis < 3; ++axis)
                    rows[corner][axis] = load(&x[3 * corner + axis][e]);
                rows[corner][3] = rows[corner][2];
                transpose(rows[corner]);
            }
            for (int k = 0; k < 4; ++k)
                for (int corner = 0; corner < corners; ++corner)
                    add_row(gradient + 3 * corner_of[corners * (e + k) + corner], rows[corner][k]);
        }
        for (; e < count; ++e)
            for (int corner = 0; corner < corners; ++corner) {
                double* g = gradient + 3 * corner_of[corners * e + corner];
                for (int axis = 0; axis < 3; ++axis) g[axis] += x[3 * corner + axis][e];
            }
    }

    double total_energy(int count) const {
        double total = 0.0;
        for (int e = 0; e < count; ++e) total += energy[e];
        return total;
    }

 private:
    using Pair = double __attribute__((vector_size(16)));

    static Pair pair(const double* p) {
        Pair v;
        std::memcpy(&v, p, sizeof(v));
        return v;
    }

    /// Four rows become four columns of x, y and z. Nothing behind a row is read.
    static void read_four(const std::array<const double*, 4>& p, double (*columns)[size], int e) {
        const Pair a = pair(p[0]), b = pair(p[1]), c = pair(p[2]), d = pair(p[3]);
        const DoubleLanes ab = __builtin_shufflevector(a, b, 0, 2, 1, 3);
        const DoubleLanes cd = __builtin_shufflevector(c, d, 0, 2, 1, 3);
        store(&columns[0][e], DoubleLanes(__builtin_shufflevector(ab, cd, 0, 1, 4, 5)));
        store(&columns[1][e], DoubleLanes(__builtin_shufflevector(ab, cd, 2, 3, 6, 7)));
        store(&columns[2][e], DoubleLanes{p[0][2], p[1][2], p[2][2], p[3][2]});
    }

    static void add_row(double* g, const DoubleLanes& by) {
        const Pair sum = pair(g) + Pair{by[0], by[1]};
        std::memcpy(g, &sum, sizeof(sum));
        g[2] += by[2];
    }
};

}  // namespace cloth
