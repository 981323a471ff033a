#include "data/core/weld.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

using Cell = std::array<long, 3>;

constexpr double farthest = 1e9;  // from the origin (m): beyond, cells have no numbers

/// Vertices that stay, by the cell of a grid as wide as the tolerance: what is near is in the cell
/// of a point or in one of its neighbours.
class NearVertices {
 public:
    explicit NearVertices(double tolerance) : m_tolerance(tolerance) {}

    /// The first vertex within the tolerance of p, -1 if there is none.
    int find(const Points& vertices, const Vec3& p) const {
        int first = -1;
        const Cell centre = cell_of(p);
        for (long i = -1; i <= 1; ++i)
            for (long j = -1; j <= 1; ++j)
                for (long k = -1; k <= 1; ++k) {
                    const auto cell = m_cells.find({centre[0] + i, centre[1] + j, centre[2] + k});
                    if (cell == m_cells.end()) continue;
                    for (const int v : cell->second)
                        if ((vertices.row(v).transpose() - p).norm() <= m_tolerance &&
                            (first < 0 || v < first))
                            first = v;
                }
        return first;
    }

    void add(int vertex, const Vec3& p) { m_cells[cell_of(p)].push_back(vertex); }

 private:
    Cell cell_of(const Vec3& p) const {
        const double size = std::max(m_tolerance, 1e-6);
        return {std::lround(p[0] / size), std::lround(p[1] / size), std::lround(p[2] / size)};
    }

    double m_tolerance;
    std::map<Cell, std::vector<int>> m_cells;
};

void check_mesh(const TriMesh& mesh) {
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i)
        if (!mesh.vertices.row(i).allFinite())
            throw ArgumentError("weld_mesh: vertex " + std::to_string(i), "it is not finite",
                                "give finite positions in metres");
    if (mesh.vertices.size() > 0 && mesh.vertices.cwiseAbs().maxCoeff() > farthest)
        throw ArgumentError("weld_mesh: vertices", "one is a million kilometres away",
                            "give positions in metres");
    if (mesh.faces.size() > 0 &&
        (mesh.faces.minCoeff() < 0 || mesh.faces.maxCoeff() >= mesh.vertices.rows()))
        throw ArgumentError("weld_mesh: faces", "one refers to a vertex that does not exist",
                            "number vertices from 0 to |V| - 1");
}

/// |V|: the vertex that each becomes.
std::vector<int> representatives(const Points& vertices, double tolerance) {
    NearVertices near(tolerance);
    std::vector<int> result;
    for (int i = 0; i < vertices.rows(); ++i) {
        const int known = near.find(vertices, vertices.row(i));
        if (known < 0) near.add(i, vertices.row(i));
        result.push_back(known < 0 ? i : known);
    }
    return result;
}

}  // namespace

WeldedMesh weld_mesh(const TriMesh& mesh, double tolerance) {
    check_range("weld_mesh: tolerance", tolerance, 0.0, 0.01);
    check_mesh(mesh);
    WeldedMesh result;
    result.target = representatives(mesh.vertices, tolerance);
    const std::vector<int>& target = result.target;
    for (int i = 0; i < mesh.vertices.rows(); ++i) result.merged += target[i] != i;

    std::vector<std::array<int, 3>> faces;
    std::vector<int> number(target.size(), -1);  // of the vertices that faces use
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        std::array<int, 3> corners;
        for (int c = 0; c < 3; ++c) corners[c] = target[mesh.faces(f, c)];
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
            ++result.dropped_faces;
            continue;
        }
        faces.push_back(corners);
        for (const int corner : corners) number[corner] = 0;
    }
    for (int i = 0; i < mesh.vertices.rows(); ++i) {
        if (number[i] < 0) continue;
        number[i] = static_cast<int>(result.kept.size());
        result.kept.push_back(i);
    }
    result.mesh.vertices.resize(static_cast<Eigen::Index>(result.kept.size()), 3);
    for (size_t i = 0; i < result.kept.size(); ++i)
        result.mesh.vertices.row(static_cast<Eigen::Index>(i)) = mesh.vertices.row(result.kept[i]);
    result.mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
    for (size_t f = 0; f < faces.size(); ++f)
        for (int c = 0; c < 3; ++c)
            result.mesh.faces(static_cast<Eigen::Index>(f), c) = number[faces[f][c]];
    return result;
}

}  // namespace cloth
