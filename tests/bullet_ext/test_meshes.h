#pragma once

#include <cmath>

#include "data/core/mesh.h"

namespace cloth::test {

/// A level sheet of n x n vertices from (0, 0, 0) to (1, 0, 1), faces upward.
inline TriMesh square_mesh(int n) {
    TriMesh mesh;
    mesh.vertices.resize(n * n, 3);
    mesh.faces.resize(2 * (n - 1) * (n - 1), 3);
    for (int j = 0, f = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            mesh.vertices.row(j * n + i) << i / (n - 1.0), 0, j / (n - 1.0);
            if (i + 1 == n || j + 1 == n) continue;
            const int a = j * n + i;
            mesh.faces.row(f++) << a, a + n, a + 1;
            mesh.faces.row(f++) << a + 1, a + n, a + n + 1;
        }
    return mesh;
}

/// A closed sphere at the origin of `rings` rings of 2 rings vertices and two poles.
inline TriMesh sphere_mesh(double radius, int rings) {
    const int around = 2 * rings;
    TriMesh mesh;
    mesh.vertices.resize(rings * around + 2, 3);
    mesh.faces.resize(2 * rings * around, 3);
    for (int r = 0; r < rings; ++r)
        for (int s = 0; s < around; ++s) {
            const double t = M_PI * (r + 1) / (rings + 1), p = 2.0 * M_PI * s / around;
            mesh.vertices.row(r * around + s) << radius * std::sin(t) * std::cos(p),
                radius * std::cos(t), radius * std::sin(t) * std::sin(p);
        }
    const int top = rings * around, bottom = top + 1;
    mesh.vertices.row(top) << 0, radius, 0;
    mesh.vertices.row(bottom) << 0, -radius, 0;
    for (int s = 0, f = 0; s < around; ++s) {
        const int next = (s + 1) % around, last = (rings - 1) * around;
        mesh.faces.row(f++) << top, next, s;
        mesh.faces.row(f++) << bottom, last + s, last + next;
        for (int r = 0; r + 1 < rings; ++r) {
            const int a = r * around;
            mesh.faces.row(f++) << a + s, a + next, a + around + s;
            mesh.faces.row(f++) << a + next, a + around + next, a + around + s;
        }
    }
    return mesh;
}

}  // namespace cloth::test
