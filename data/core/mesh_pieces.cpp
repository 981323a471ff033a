#include "data/core/mesh_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "data/core/errors.h"

namespace cloth {

namespace {

int root_of(std::vector<int>& parent, int i) {
    while (parent[static_cast<size_t>(i)] != i) {
        int& up = parent[static_cast<size_t>(i)];
        up = parent[static_cast<size_t>(up)];
        i = up;
    }
    return i;
}

}  // namespace

std::vector<int> face_pieces(const Faces& faces) {
    if (faces.rows() == 0) return {};
    std::vector<int> parent(static_cast<size_t>(faces.maxCoeff()) + 1);
    std::iota(parent.begin(), parent.end(), 0);
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int c = 1; c < 3; ++c) {
            const int a = root_of(parent, faces(f, 0)), b = root_of(parent, faces(f, c));
            parent[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
        }
    std::map<int, int> numbers;
    std::vector<int> pieces;
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const int root = root_of(parent, faces(f, 0));
        pieces.push_back(numbers.emplace(root, static_cast<int>(numbers.size())).first->second);
    }
    return pieces;
}

int piece_count(const std::vector<int>& face_pieces) {
    return face_pieces.empty() ? 0 : *std::max_element(face_pieces.begin(), face_pieces.end()) + 1;
}

TriMesh keep_faces(const TriMesh& mesh, const std::vector<char>& keep) {
    std::vector<int> number(static_cast<size_t>(mesh.vertices.rows()), -1);
    std::vector<Eigen::Index> rows;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        if (!keep[static_cast<size_t>(f)]) continue;
        rows.push_back(f);
        for (int c = 0; c < 3; ++c) number[static_cast<size_t>(mesh.faces(f, c))] = 0;
    }
    std::vector<int> used;
    for (size_t i = 0; i < number.size(); ++i)
        if (number[i] == 0) {
            number[i] = static_cast<int>(used.size());
            used.push_back(static_cast<int>(i));
        }
    TriMesh kept{mesh.vertices(used, Eigen::all), mesh.faces(rows, Eigen::all)};
    for (Eigen::Index f = 0; f < kept.faces.rows(); ++f)
        for (int c = 0; c < 3; ++c)
            kept.faces(f, c) = number[static_cast<size_t>(kept.faces(f, c))];
    return kept;
}

TriMesh piece_of(const TriMesh& mesh, const std::vector<int>& face_pieces, int piece) {
    std::vector<char> keep;
    for (const int of : face_pieces) keep.push_back(of == piece);
    return keep_faces(mesh, keep);
}

std::vector<std::pair<int, int>> border_edges(const Faces& faces) {
    std::set<std::pair<int, int>> edges;
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int c = 0; c < 3; ++c) edges.insert({faces(f, c), faces(f, (c + 1) % 3)});
    std::vector<std::pair<int, int>> border;
    for (const auto& [from, to] : edges)
        if (!edges.count({to, from})) border.emplace_back(from, to);
    return border;
}

double border_share(const Faces& faces) {
    std::map<std::array<int, 2>, int> uses;
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int c = 0; c < 3; ++c) {
            const int a = faces(f, c), b = faces(f, (c + 1) % 3);
            ++uses[{std::min(a, b), std::max(a, b)}];
        }
    const auto borders =
        std::count_if(uses.begin(), uses.end(), [](const auto& edge) { return edge.second == 1; });
    return uses.empty() ? 0.0 : static_cast<double>(borders) / static_cast<double>(uses.size());
}

double signed_volume(const TriMesh& mesh) {
    if (mesh.vertices.rows() == 0) return 0.0;
    const Points x = mesh.vertices.rowwise() - mesh.vertices.colwise().mean();
    double volume = 0.0;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        const Vec3 a = x.row(mesh.faces(f, 0)), b = x.row(mesh.faces(f, 1)),
                   c = x.row(mesh.faces(f, 2));
        volume += a.dot(b.cross(c)) / 6.0;
    }
    return volume;
}

void validate_skin(const std::string& name, const TriMesh& skin) {
    validate_mesh(name, skin);
    const Eigen::RowVector3d low = skin.vertices.colwise().minCoeff(),
                             high = skin.vertices.colwise().maxCoeff();
    // The volume of a flat strip is rounding, of either sign.
    if (signed_volume(skin) < -1e-12 * std::pow((high - low).norm(), 3))
        throw ArgumentError(name, "it is inside out: its faces look inwards",
                            "turn its faces (flip normals) in a mesh editor");
}

}  // namespace cloth
