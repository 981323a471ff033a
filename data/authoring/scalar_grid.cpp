#include "data/authoring/scalar_grid.h"

#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace cloth {

ScalarGrid::ScalarGrid(const Vec3& low, const Vec3& high, double cell,
                       const std::function<double(const Vec3&)>& f)
    : m_low(low), m_cell(cell) {
    for (int axis = 0; axis < 3; ++axis)
        m_size[axis] = static_cast<int>(std::ceil((high[axis] - low[axis]) / cell)) + 1;
    m_values.resize(static_cast<size_t>(m_size[0]) * static_cast<size_t>(m_size[1]) *
                    static_cast<size_t>(m_size[2]));
    for (size_t n = 0; n < m_values.size(); ++n) m_values[n] = f(position(n));
}

Vec3 ScalarGrid::position(size_t n) const {
    const size_t nx = static_cast<size_t>(m_size[0]), ny = static_cast<size_t>(m_size[1]);
    return m_low + m_cell * Vec3(static_cast<double>(n % nx), static_cast<double>(n / nx % ny),
                                 static_cast<double>(n / nx / ny));
}

void ScalarGrid::blur_axis(int axis) {
    const size_t stride = axis == 0 ? 1 : axis == 1 ? index(0, 1, 0) : index(0, 0, 1);
    const std::vector<double> old = m_values;
    for (int k = 0; k < m_size[2]; ++k)
        for (int j = 0; j < m_size[1]; ++j)
            for (int i = 0; i < m_size[0]; ++i) {
                const int at = axis == 0 ? i : axis == 1 ? j : k;
                if (at == 0 || at == m_size[axis] - 1) continue;
                const size_t n = index(i, j, k);
                m_values[n] = 0.25 * old[n - stride] + 0.5 * old[n] + 0.25 * old[n + stride];
            }
}

void ScalarGrid::blur(int passes) {
    for (int pass = 0; pass < passes; ++pass)
        for (int axis = 0; axis < 3; ++axis) blur_axis(axis);
}

namespace {

/// Collects triangles whose corners lie on grid edges, each grid edge giving one vertex.
class TriangleCollector {
 public:
    using Cut = std::pair<size_t, size_t>;  // grid points: inside, outside

    void add(const Cut& a, const Cut& b, const Cut& c) {
        m_faces.push_back({number(a), number(b), number(c)});
    }

    template <typename PositionOf>
    TriMesh finish(const PositionOf& position) const {
        TriMesh mesh;
        mesh.vertices.resize(static_cast<Eigen::Index>(m_numbers.size()), 3);
        for (const auto& [cut, i] : m_numbers) mesh.vertices.row(i) = position(cut).transpose();
        mesh.faces.resize(static_cast<Eigen::Index>(m_faces.size()), 3);
        for (size_t f = 0; f < m_faces.size(); ++f)
            mesh.faces.row(static_cast<Eigen::Index>(f)) << m_faces[f][0], m_faces[f][1],
                m_faces[f][2];
        return mesh;
    }

 private:
    int number(const Cut& cut) {
        return m_numbers.try_emplace(cut, static_cast<int>(m_numbers.size())).first->second;
    }

    std::map<Cut, int> m_numbers;
    std::vector<std::array<int, 3>> m_faces;
};

/// The surface inside one tetrahedron of positive volume: (b - a) x (c - a) points towards d.
void cut_tetrahedron(const std::array<size_t, 4>& t, const std::vector<double>& values,
                     TriangleCollector& triangles) {
    std::vector<int> in, out;
    for (int c = 0; c < 4; ++c) (values[t[static_cast<size_t>(c)]] < 0.0 ? in : out).push_back(c);
    if (in.empty() || out.empty()) return;
    const auto cut = [&](int i, int o) {
        return TriangleCollector::Cut(t[static_cast<size_t>(i)], t[static_cast<size_t>(o)]);
    };
    // The sign of the permutation (in..., out...) says which way round the polygon is.
    int order[4];
    int n = 0;
    for (int c : in) order[n++] = c;
    for (int c : out) order[n++] = c;
    bool odd = false;
    for (int i = 0; i < 4; ++i)
        for (int j = i + 1; j < 4; ++j) odd ^= order[i] > order[j];
    std::vector<TriangleCollector::Cut> polygon;
    if (in.size() == 1)
        polygon = {cut(in[0], out[0]), cut(in[0], out[1]), cut(in[0], out[2])};
    else if (in.size() == 3)
        polygon = {cut(in[0], out[0]), cut(in[2], out[0]), cut(in[1], out[0])};
    else
        polygon = {cut(in[0], out[0]), cut(in[0], out[1]), cut(in[1], out[1]), cut(in[1], out[0])};
    if (in.size() == 3) odd = !odd;
    if (odd) std::swap(polygon[1], polygon[polygon.size() - 1]);
    for (size_t c = 1; c + 1 < polygon.size(); ++c)
        triangles.add(polygon[0], polygon[c], polygon[c + 1]);
}

/// The six tetrahedra around the diagonal 0-7 of a cube; corner number = x + 2 y + 4 z.
constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                   {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};

}  // namespace

TriMesh ScalarGrid::zero_surface() const {
    TriangleCollector triangles;
    for (int k = 0; k + 1 < m_size[2]; ++k)
        for (int j = 0; j + 1 < m_size[1]; ++j)
            for (int i = 0; i + 1 < m_size[0]; ++i)
                for (const auto& tetrahedron : kTetrahedra) {
                    std::array<size_t, 4> corners;
                    for (size_t c = 0; c < 4; ++c)
                        corners[c] = index(i + (tetrahedron[c] & 1), j + (tetrahedron[c] >> 1 & 1),
                                           k + (tetrahedron[c] >> 2));
                    cut_tetrahedron(corners, m_values, triangles);
                }
    return triangles.finish([this](const TriangleCollector::Cut& cut) -> Vec3 {
        const double a = m_values[cut.first], b = m_values[cut.second];
        const double t = std::min(0.98, std::max(0.02, a / (a - b)));  // no face without area
        return (1.0 - t) * position(cut.first) + t * position(cut.second);
    });
}

}  // namespace cloth
