#include "data/core/mesh_repair.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "data/core/errors.h"
#include "data/core/mesh_pieces.h"

namespace cloth {

namespace {

constexpr double smallest_area = 1e-14;   // (m^2), as validate_mesh() has it
constexpr double smallest_height = 1e-6;  // of a face, as a part of its longest edge

using Edge = std::array<int, 2>;

/// A face beside an edge, and whether it passes it from the lower to the higher vertex.
struct EdgeSide {
    int face;
    bool ascending;
};
using EdgeSides = std::map<Edge, std::vector<EdgeSide>>;

EdgeSides edge_sides(const Faces& faces) {
    EdgeSides sides;
    for (int f = 0; f < faces.rows(); ++f)
        for (int c = 0; c < 3; ++c) {
            const int a = faces(f, c), b = faces(f, (c + 1) % 3);
            sides[{std::min(a, b), std::max(a, b)}].push_back({f, a < b});
        }
    return sides;
}

std::array<int, 3> sorted_corners(const Faces& faces, Eigen::Index f) {
    std::array<int, 3> corners{faces(f, 0), faces(f, 1), faces(f, 2)};
    std::sort(corners.begin(), corners.end());
    return corners;
}

bool has_area(const TriMesh& mesh, Eigen::Index f) {
    double longest = 0.0;
    for (int c = 0; c < 3; ++c)
        longest = std::max(longest, (mesh.vertices.row(mesh.faces(f, c)) -
                                     mesh.vertices.row(mesh.faces(f, (c + 1) % 3)))
                                        .norm());
    const double area = face_area_vectors(mesh.vertices, mesh.faces.row(f)).rowwise().norm()[0];
    return area > smallest_area && 2.0 * area > smallest_height * longest * longest;
}

/// Away from the edge, within the face, and perpendicular to the edge: unit length.
Vec3 wing(const TriMesh& mesh, const Edge& edge, int face) {
    const Vec3 a = mesh.vertices.row(edge[0]);
    const Vec3 along = (mesh.vertices.row(edge[1]).transpose() - a).normalized();
    Vec3 tip = a;
    for (int c = 0; c < 3; ++c)
        if (mesh.faces(face, c) != edge[0] && mesh.faces(face, c) != edge[1])
            tip = mesh.vertices.row(mesh.faces(face, c));
    const Vec3 out = tip - a;
    return (out - out.dot(along) * along).normalized();
}

/// Of a square that is there from both sides, and that was cut along one diagonal on one side and
/// along the other one on the other, the two triangles that come later.
void leave_out_other_diagonals(const TriMesh& mesh, std::vector<char>& keep, int& left_out) {
    constexpr double flat = -0.5;  // cosine between the triangles: above it is no square
    std::map<std::array<int, 3>, int> numbers;
    std::map<Edge, std::vector<int>> beside;
    for (int f = 0; f < mesh.faces.rows(); ++f) {
        if (!keep[static_cast<size_t>(f)]) continue;
        numbers[sorted_corners(mesh.faces, f)] = f;
        for (int c = 0; c < 3; ++c) {
            const int a = mesh.faces(f, c), b = mesh.faces(f, (c + 1) % 3);
            beside[{std::min(a, b), std::max(a, b)}].push_back(f);
        }
    }
    const auto other_corner = [&](int face, const Edge& edge) {
        return mesh.faces.row(face).sum() - edge[0] - edge[1];
    };
    const auto kept_face = [&](std::array<int, 3> corners) {
        std::sort(corners.begin(), corners.end());
        const auto at = numbers.find(corners);
        return at != numbers.end() && keep[static_cast<size_t>(at->second)] ? at->second : -1;
    };
    for (const auto& [edge, faces] : beside)
        for (size_t i = 0; i < faces.size(); ++i)
            for (size_t j = i + 1; j < faces.size(); ++j) {
                const int first = faces[i], second = faces[j];
                if (!keep[static_cast<size_t>(first)] || !keep[static_cast<size_t>(second)])
                    continue;
                const int b = other_corner(first, edge), d = other_corner(second, edge);
                const int third = kept_face({edge[0], b, d}), fourth = kept_face({edge[1], b, d});
                if (third < 0 || fourth < 0 || first > std::min(third, fourth)) continue;
                if (wing(mesh, edge, first).dot(wing(mesh, edge, second)) > flat) continue;
                keep[static_cast<size_t>(third)] = keep[static_cast<size_t>(fourth)] = 0;
                left_out += 2;
            }
}

void leave_out_useless_faces(RepairedMesh& result, const std::string& name) {
    TriMesh& mesh = result.mesh;
    std::set<std::array<int, 3>> known;
    std::vector<char> keep(static_cast<size_t>(mesh.faces.rows()), 1);
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        const bool flat = !has_area(mesh, f);
        const bool again = !flat && !known.insert(sorted_corners(mesh.faces, f)).second;
        result.faces_without_area += flat;
        result.duplicate_faces += again;
        keep[static_cast<size_t>(f)] = !flat && !again;
    }
    leave_out_other_diagonals(mesh, keep, result.duplicate_faces);
    mesh = keep_faces(mesh, keep);
    if (mesh.faces.rows() == 0)
        throw ArgumentError(name, "it has no face with an area",
                            "export the mesh again as triangles or polygons");
}

/// Of three and more faces at an edge the two that continue each other best.
std::array<EdgeSide, 2> flattest_pair(const TriMesh& mesh, const Edge& edge,
                                      const std::vector<EdgeSide>& sides) {
    std::array<EdgeSide, 2> best{sides[0], sides[1]};
    double lowest = 2.0;
    for (size_t i = 0; i < sides.size(); ++i)
        for (size_t j = i + 1; j < sides.size(); ++j) {
            const double cosine =
                wing(mesh, edge, sides[i].face).dot(wing(mesh, edge, sides[j].face));
            if (cosine < lowest) {
                lowest = cosine;
                best = {sides[i], sides[j]};
            }
        }
    return best;
}

/// Faces that go on into each other across an edge.
struct Link {
    Edge edge;
    std::array<EdgeSide, 2> sides;
};

std::vector<Link> links_of(const TriMesh& mesh, int& cut_edges) {
    std::vector<Link> links;
    for (const auto& [edge, sides] : edge_sides(mesh.faces)) {
        if (sides.size() < 2) continue;
        if (sides.size() == 2)
            links.push_back({edge, {sides[0], sides[1]}});
        else
            links.push_back({edge, flattest_pair(mesh, edge, sides)});
        cut_edges += sides.size() > 2;
    }
    return links;
}

/// The fans of faces around the vertices: a union-find over the corners of all faces.
class CornerFans {
 public:
    explicit CornerFans(const Faces& faces)
        : m_faces(faces), m_parent(static_cast<size_t>(faces.size())) {
        std::iota(m_parent.begin(), m_parent.end(), 0);
    }

    void join(const Link& link) {
        for (const int vertex : link.edge) {
            const int a = fan(corner_of(link.sides[0].face, vertex));
            const int b = fan(corner_of(link.sides[1].face, vertex));
            m_parent[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
        }
    }

    int fan(int corner) {
        while (m_parent[static_cast<size_t>(corner)] != corner) {
            int& up = m_parent[static_cast<size_t>(corner)];
            up = m_parent[static_cast<size_t>(up)];
            corner = up;
        }
        return corner;
    }

 private:
    int corner_of(int face, int vertex) const {
        int c = 0;
        while (m_faces(face, c) != vertex) ++c;
        return 3 * face + c;
    }

    const Faces& m_faces;
    std::vector<int> m_parent;
};

/// Each fan of faces around a vertex but the first gets a vertex of its own.
void split_vertices(RepairedMesh& result, const std::vector<Link>& links) {
    const Faces before = result.mesh.faces;
    CornerFans fans(before);
    for (const Link& link : links) fans.join(link);
    std::vector<int> first(static_cast<size_t>(result.mesh.vertices.rows()), -1);
    std::map<int, int> copies;  // of a fan: its vertex
    std::vector<int> originals(static_cast<size_t>(result.mesh.vertices.rows()));
    std::iota(originals.begin(), originals.end(), 0);
    for (int f = 0; f < before.rows(); ++f)
        for (int c = 0; c < 3; ++c) {
            const int vertex = before(f, c), fan = fans.fan(3 * f + c);
            int& owner = first[static_cast<size_t>(vertex)];
            if (owner < 0) owner = fan;
            if (owner == fan) continue;
            const auto [copy, is_new] = copies.emplace(fan, static_cast<int>(originals.size()));
            if (is_new) originals.push_back(vertex);
            result.mesh.faces(f, c) = copy->second;
        }
    result.split_vertices = static_cast<int>(copies.size());
    result.mesh.vertices = Points(result.mesh.vertices(originals, Eigen::all));
}

/// Turns faces so that neighbours pass their edge in opposite directions.
void agree_on_outside(RepairedMesh& result, const std::vector<Link>& links) {
    Faces& faces = result.mesh.faces;
    const auto count = static_cast<size_t>(faces.rows());
    struct Neighbour {
        int face;
        bool agrees;
    };
    std::vector<std::vector<Neighbour>> neighbours(count);
    for (const Link& link : links) {
        const bool agrees = link.sides[0].ascending != link.sides[1].ascending;
        neighbours[static_cast<size_t>(link.sides[0].face)].push_back({link.sides[1].face, agrees});
        neighbours[static_cast<size_t>(link.sides[1].face)].push_back({link.sides[0].face, agrees});
    }
    std::vector<int> turn(count, -1);  // 1: the other way than the first face of its piece
    for (size_t start = 0; start < count; ++start) {
        if (turn[start] >= 0) continue;
        std::vector<int> piece{static_cast<int>(start)};
        turn[start] = 0;
        bool one_sided = false;
        for (size_t k = 0; k < piece.size(); ++k) {
            const auto at = static_cast<size_t>(piece[k]);
            for (const Neighbour& next : neighbours[at]) {
                const int wanted = next.agrees ? turn[at] : 1 - turn[at];
                int& there = turn[static_cast<size_t>(next.face)];
                if (there < 0) {
                    there = wanted;
                    piece.push_back(next.face);
                } else if (there != wanted) {
                    one_sided = true;
                }
            }
        }
        result.one_sided_pieces += one_sided;
        const auto turned = static_cast<size_t>(std::count_if(
            piece.begin(), piece.end(), [&](int f) { return turn[static_cast<size_t>(f)] == 1; }));
        const int minority = 2 * turned <= piece.size() ? 1 : 0;
        for (const int f : piece)
            if (!one_sided && turn[static_cast<size_t>(f)] == minority) {
                std::swap(faces(f, 1), faces(f, 2));
                ++result.turned_faces;
            }
    }
}

void check_edges(const TriMesh& mesh, const std::string& name) {
    for (const auto& [edge, sides] : edge_sides(mesh.faces)) {
        if (sides.size() <= 2) continue;
        const Vec3 at = 0.5 * (mesh.vertices.row(edge[0]) + mesh.vertices.row(edge[1]));
        char place[96];
        std::snprintf(place, sizeof place, "(%.4g, %.4g, %.4g)", at.x(), at.y(), at.z());
        throw ArgumentError(name,
                            "the edge at " + std::string(place) + " has " +
                                std::to_string(sides.size()) +
                                " faces, and cutting does not part them",
                            "delete inner faces there in a mesh editor");
    }
}

}  // namespace

RepairedMesh repair_mesh(const TriMesh& mesh, const std::string& name) {
    RepairedMesh result;
    result.mesh = mesh;
    leave_out_useless_faces(result, name);
    const std::vector<Link> links = links_of(result.mesh, result.cut_edges);
    split_vertices(result, links);
    agree_on_outside(result, links);
    check_edges(result.mesh, name);
    return result;
}

}  // namespace cloth
