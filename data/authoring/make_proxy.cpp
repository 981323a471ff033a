#include "data/authoring/make_proxy.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "data/authoring/mesh_quality.h"
#include "data/authoring/surface_edit.h"
#include "data/core/carry_over.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/garment_pieces.h"

namespace cloth {

namespace {

constexpr double kCorner = 35.0;  // degrees that a border turns
constexpr int kFewest = 12;       // vertices of a piece: fewer are no surface that could drape

/// A connected piece of a garment as a mesh of its own.
struct Piece {
    TriMesh mesh;
    std::vector<int> vertices;  ///< of the garment
    std::vector<char> pinned;   ///< of its vertices
    double area = 0.0;          ///< (m^2)
};

std::vector<Piece> pieces_of(const Garment& garment) {
    const std::vector<int> piece = garment_pieces(garment);
    std::vector<Piece> pieces(static_cast<size_t>(*std::max_element(piece.begin(), piece.end())) +
                              1);
    std::vector<int> place(piece.size());
    for (size_t v = 0; v < piece.size(); ++v) {
        Piece& own = pieces[static_cast<size_t>(piece[v])];
        place[v] = static_cast<int>(own.vertices.size());
        own.vertices.push_back(static_cast<int>(v));
        own.pinned.push_back(garment.is_pinned()[v]);
    }
    std::vector<std::vector<Eigen::Index>> faces(pieces.size());
    const Faces& all = garment.rest().faces;
    for (Eigen::Index f = 0; f < all.rows(); ++f) {
        const auto p = static_cast<size_t>(piece[static_cast<size_t>(all(f, 0))]);
        faces[p].push_back(f);
        pieces[p].area += garment.face_areas()[f];
    }
    for (size_t p = 0; p < pieces.size(); ++p) {
        TriMesh& mesh = pieces[p].mesh;
        mesh.vertices.resize(static_cast<Eigen::Index>(pieces[p].vertices.size()), 3);
        for (size_t v = 0; v < pieces[p].vertices.size(); ++v)
            mesh.vertices.row(static_cast<Eigen::Index>(v)) =
                garment.rest().vertices.row(pieces[p].vertices[v]);
        mesh.faces.resize(static_cast<Eigen::Index>(faces[p].size()), 3);
        for (size_t f = 0; f < faces[p].size(); ++f)
            for (int c = 0; c < 3; ++c)
                mesh.faces(static_cast<Eigen::Index>(f), c) =
                    place[static_cast<size_t>(all(faces[p][f], c))];
    }
    return pieces;
}

/// The sharpest turns of the borders, in falling order.
std::vector<int> corners(const TriMesh& mesh) {
    std::vector<std::pair<double, int>> turns;
    for (const std::vector<int>& loop : boundary_loops(mesh.faces))
        for (size_t k = 0; k < loop.size(); ++k) {
            const Vec3 before = mesh.vertices.row(loop[(k + loop.size() - 1) % loop.size()]);
            const Vec3 at = mesh.vertices.row(loop[k]);
            const Vec3 after = mesh.vertices.row(loop[(k + 1) % loop.size()]);
            const Vec3 u = at - before, v = after - at;
            const double turn = std::atan2(u.cross(v).norm(), u.dot(v)) * 180.0 / M_PI;
            if (turn > kCorner) turns.emplace_back(-turn, loop[k]);
        }
    std::sort(turns.begin(), turns.end());
    std::vector<int> result;
    for (const auto& turn : turns) result.push_back(turn.second);
    return result;
}

/// Pins that are not in the midst of others: what is pinned all around is met by any triangles.
std::vector<int> outlying_pins(const Piece& piece) {
    std::vector<char> outlying(piece.pinned.size(), 0);
    for (Eigen::Index f = 0; f < piece.mesh.faces.rows(); ++f) {
        bool all = true;
        for (int c = 0; c < 3; ++c)
            all = all && piece.pinned[static_cast<size_t>(piece.mesh.faces(f, c))];
        for (int c = 0; !all && c < 3; ++c)
            outlying[static_cast<size_t>(piece.mesh.faces(f, c))] = 1;
    }
    std::vector<int> pins;
    for (size_t v = 0; v < piece.pinned.size(); ++v)
        if (piece.pinned[v] && outlying[v]) pins.push_back(static_cast<int>(v));
    return pins;
}

std::string degrees(double angle) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.1f", angle);
    return digits;
}

void check_surface(const std::string& name, const TriMesh& mesh) {
    const Topology shape = topology(mesh.faces);
    if (!shape.manifold)
        throw ArgumentError(name, "the surface meets itself in a vertex, so it is no two-manifold",
                            "split the mesh there");
    if (!shape.oriented)
        throw ArgumentError(name, "neighbouring faces disagree on which side is outside",
                            "make the normals consistent");
}

TriMesh coarse_piece(const std::string& name, const Piece& piece, double share,
                     const ProxySettings& settings) {
    const auto target = static_cast<int>(std::lround(share * settings.vertices));
    if (static_cast<size_t>(target) >= piece.vertices.size()) return piece.mesh;
    if (target < kFewest)
        throw ArgumentError(
            name,
            "its share of the area is " + std::to_string(target) + " of " +
                std::to_string(settings.vertices) + " vertices: it is hardly larger than an edge",
            "ask for " + std::to_string(static_cast<int>(std::ceil(kFewest / share))) +
                " vertices or more, or leave the piece out");
    std::vector<int> kept = corners(piece.mesh);
    const std::vector<int> pins = outlying_pins(piece);
    // A corner that is pinned comes first.
    std::stable_partition(kept.begin(), kept.end(),
                          [&](int v) { return piece.pinned[static_cast<size_t>(v)] != 0; });
    kept.insert(kept.end(), pins.begin(), pins.end());
    TriMesh coarse = remesh(piece.mesh, target, kept);

    const std::string remedy = "ask for more vertices, or repair the mesh there";
    const Topology before = topology(piece.mesh.faces), after = topology(coarse.faces);
    if (!after.manifold || !after.oriented || after.components != 1 ||
        after.boundary_loops != before.boundary_loops ||
        after.euler_characteristic != before.euler_characteristic)
        throw ArgumentError(name, "it is too thin somewhere for triangles so large", remedy);
    const double angle = smallest_angle(coarse);
    if (angle < settings.smallest_angle)
        throw ArgumentError(name,
                            "the coarse mesh has an angle of " + degrees(angle) +
                                " degrees, less than " + degrees(settings.smallest_angle),
                            remedy + ", or lower ProxySettings.smallest_angle");
    return coarse;
}

void append(const TriMesh& mesh, TriMesh& all) {
    const Eigen::Index vertices = all.vertices.rows(), faces = all.faces.rows();
    all.vertices.conservativeResize(vertices + mesh.vertices.rows(), 3);
    all.faces.conservativeResize(faces + mesh.faces.rows(), 3);
    all.vertices.bottomRows(mesh.vertices.rows()) = mesh.vertices;
    all.faces.bottomRows(mesh.faces.rows()) = mesh.faces.array() + static_cast<int>(vertices);
}

}  // namespace

Garment make_proxy(const Garment& fine, const ProxySettings& settings) {
    check_range("ProxySettings.vertices", settings.vertices, 20, 100000);
    check_range("ProxySettings.smallest_angle", settings.smallest_angle, 1.0, 25.0);
    if (fine.vertex_count() <= settings.vertices)
        throw ArgumentError(fine.name(),
                            "it has " + std::to_string(fine.vertex_count()) +
                                " vertices, so a proxy of " + std::to_string(settings.vertices) +
                                " would not be coarser",
                            "ask for fewer, or simulate the garment itself");
    const std::vector<Piece> pieces = pieces_of(fine);
    const double area = fine.face_areas().sum();
    TriMesh mesh{Points(0, 3), Faces(0, 3)};
    for (const Piece& piece : pieces) {
        const std::string name = pieces.size() == 1 ? fine.name()
                                                    : fine.name() + ", the piece of vertex " +
                                                          std::to_string(piece.vertices.front());
        check_surface(name, piece.mesh);
        append(coarse_piece(name, piece, piece.area / area, settings), mesh);
    }
    return carry_over(fine, std::move(mesh), fine.name() + " proxy");
}

}  // namespace cloth
