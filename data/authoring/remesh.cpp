#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "data/authoring/edge_flips.h"
#include "data/authoring/mesh_quality.h"
#include "data/authoring/surface_edit.h"
#include "data/core/errors.h"
#include "data/core/surface_distance.h"

namespace cloth {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using VertexIndex = SurfaceMesh::Vertex_index;

constexpr double kGoodGarmentAngle = 25.0;  // degrees at which the smoothing stops
constexpr int kFirstRounds = 5;             // at least: the remesher leaves the borders wavy
constexpr int kSmoothingRounds = 60;
constexpr double kKeptSpacing = 0.9;  // of vertices that are kept (edge lengths)
constexpr double kFolded = -0.5;      // cosine between the normals at a fold, at most

SurfaceMesh to_cgal(const TriMesh& mesh) {
    SurfaceMesh result;
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i)
        result.add_vertex({mesh.vertices(i, 0), mesh.vertices(i, 1), mesh.vertices(i, 2)});
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        const auto corner = [&](int c) {
            return VertexIndex(static_cast<SurfaceMesh::size_type>(mesh.faces(f, c)));
        };
        if (result.add_face(corner(0), corner(1), corner(2)) == SurfaceMesh::null_face())
            throw ArgumentError("remesh: face " + std::to_string(f),
                                "the surface is not manifold there", "repair the surface");
    }
    return result;
}

TriMesh from_cgal(SurfaceMesh& mesh) {
    mesh.collect_garbage();
    TriMesh result;
    result.vertices.resize(static_cast<Eigen::Index>(mesh.number_of_vertices()), 3);
    for (const VertexIndex v : mesh.vertices()) {
        const auto& p = mesh.point(v);
        result.vertices.row(static_cast<Eigen::Index>(v)) << p.x(), p.y(), p.z();
    }
    result.faces.resize(static_cast<Eigen::Index>(mesh.number_of_faces()), 3);
    for (const auto f : mesh.faces()) {
        int c = 0;
        for (const VertexIndex v : vertices_around_face(mesh.halfedge(f), mesh))
            result.faces(static_cast<Eigen::Index>(f), c++) = static_cast<int>(v);
    }
    return result;
}

/// Edges at which the cloth is folded over, as a collar is: its faces meet by less than 60 degrees.
std::vector<std::array<int, 2>> folds(const TriMesh& mesh) {
    const Points normals = face_normals(mesh.vertices, mesh.faces);
    std::map<std::array<int, 2>, int> first_face;
    std::vector<std::array<int, 2>> found;
    for (int f = 0; f < mesh.faces.rows(); ++f)
        for (int c = 0; c < 3; ++c) {
            const int a = mesh.faces(f, c), b = mesh.faces(f, (c + 1) % 3);
            const std::array<int, 2> edge{std::min(a, b), std::max(a, b)};
            const auto [other, is_new] = first_face.emplace(edge, f);
            if (!is_new && normals.row(f).dot(normals.row(other->second)) < kFolded)
                found.push_back(edge);
        }
    return found;
}

TriMesh isotropic(const TriMesh& surface, double edge_length, int rounds, Folds keep) {
    SurfaceMesh mesh = to_cgal(surface);
    auto is_fold = mesh.add_property_map<SurfaceMesh::Edge_index, bool>("e:fold", false).first;
    if (keep == Folds::keep)
        for (const auto& [a, b] : folds(surface)) {
            const auto halfedge =
                mesh.halfedge(VertexIndex(static_cast<SurfaceMesh::size_type>(a)),
                              VertexIndex(static_cast<SurfaceMesh::size_type>(b)));
            if (halfedge != SurfaceMesh::null_halfedge()) is_fold[mesh.edge(halfedge)] = true;
        }
    CGAL::Polygon_mesh_processing::isotropic_remeshing(
        mesh.faces(), edge_length, mesh,
        CGAL::parameters::number_of_iterations(static_cast<unsigned>(rounds))
            .number_of_relaxation_steps(3)
            .edge_is_constrained_map(is_fold)
            .relax_constraints(false));
    return from_cgal(mesh);
}

double area(const TriMesh& mesh) {
    return face_area_vectors(mesh.vertices, mesh.faces).rowwise().norm().sum();
}

/// A closed curve, walked by its length.
class Curve {
 public:
    Curve(const Points& vertices, const std::vector<int>& loop) {
        for (int i : loop) m_points.push_back(vertices.row(i));
        m_points.push_back(m_points.front());
        m_lengths.push_back(0.0);
        for (size_t i = 1; i < m_points.size(); ++i)
            m_lengths.push_back(m_lengths.back() + (m_points[i] - m_points[i - 1]).norm());
    }

    double length() const { return m_lengths.back(); }
    /// Where along the curve a vertex of the loop is (m).
    double place(size_t index) const { return m_lengths[index]; }

    Vec3 at(double s) const {
        s -= std::floor(s / length()) * length();
        const auto next = std::upper_bound(m_lengths.begin() + 1, m_lengths.end() - 1, s);
        const size_t i = static_cast<size_t>(next - m_lengths.begin());
        const double t = (s - m_lengths[i - 1]) / (m_lengths[i] - m_lengths[i - 1]);
        return (1.0 - t) * m_points[i - 1] + t * m_points[i];
    }

    /// Where along the curve it is nearest to `p`, and how near.
    std::pair<double, double> nearest(const Vec3& p) const {
        std::pair<double, double> best(0.0, std::numeric_limits<double>::infinity());
        for (size_t i = 1; i < m_points.size(); ++i) {
            const Vec3 a = m_points[i - 1], ab = m_points[i] - a;
            const double t = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
            const double distance = (a + t * ab - p).norm();
            if (distance < best.second) best = {m_lengths[i - 1] + t * ab.norm(), distance};
        }
        return best;
    }

 private:
    std::vector<Vec3> m_points;
    std::vector<double> m_lengths;
};

/// Moves equally spaced places on a curve so that some of them are at the places in `kept`, those
/// between them equally spaced again. A place that two of `kept` are nearest to goes to the first.
void keep_places(const std::vector<double>& kept, double length, std::vector<double>& places) {
    const auto count = static_cast<int>(places.size());
    const double step = length / count;
    std::map<int, double> fixed;  // of places: how far they move
    for (const double s : kept) {
        const double index = std::round((s - places[0]) / step);
        const int k = static_cast<int>(index - std::floor(index / count) * count);
        double shift = s - places[static_cast<size_t>(k)];
        shift -= std::round(shift / length) * length;
        fixed.emplace(k, shift);
    }
    if (fixed.empty()) return;
    for (auto from = fixed.begin(); from != fixed.end(); ++from) {
        const auto next = std::next(from);
        const bool around = next == fixed.end();
        const auto& [last, last_shift] = around ? *fixed.begin() : *next;
        const int gap = last + (around ? count : 0) - from->first;
        for (int k = 0; k < gap; ++k) {
            const double t = static_cast<double>(k) / gap;
            places[static_cast<size_t>((from->first + k) % count)] +=
                (1.0 - t) * from->second + t * last_shift;
        }
    }
}

/// The remesher lets borders shrink: puts the vertices of `loop` back on the curve that it came
/// from, equally spaced, moving them as little along it as possible.
void restore_border(Points& vertices, const std::vector<int>& loop, const Curve& curve,
                    const std::vector<double>& kept) {
    const double step = curve.length() / static_cast<double>(loop.size());
    double cosine = 0.0, sine = 0.0;  // circular mean of where the first vertex should be
    for (size_t i = 0; i < loop.size(); ++i) {
        const double s = curve.nearest(vertices.row(loop[i])).first - static_cast<double>(i) * step;
        cosine += std::cos(2.0 * M_PI * s / curve.length());
        sine += std::sin(2.0 * M_PI * s / curve.length());
    }
    const double first = std::atan2(sine, cosine) / (2.0 * M_PI) * curve.length();
    std::vector<double> places(loop.size());
    for (size_t i = 0; i < loop.size(); ++i) places[i] = first + static_cast<double>(i) * step;
    keep_places(kept, curve.length(), places);
    for (size_t i = 0; i < loop.size(); ++i)
        vertices.row(loop[i]) = curve.at(places[i]).transpose();
}

void restore_borders(TriMesh& mesh, const TriMesh& original, const std::vector<int>& kept) {
    std::vector<Curve> curves;
    std::vector<std::vector<double>> kept_places;  // of each curve
    for (const std::vector<int>& loop : boundary_loops(original.faces)) {
        curves.emplace_back(original.vertices, loop);
        kept_places.emplace_back();
        for (const int i : kept) {
            const auto at = std::find(loop.begin(), loop.end(), i);
            if (at != loop.end())
                kept_places.back().push_back(
                    curves.back().place(static_cast<size_t>(at - loop.begin())));
        }
    }
    for (const std::vector<int>& loop : boundary_loops(mesh.faces)) {
        const auto gap = [&](const Curve& curve) {
            double sum = 0.0;
            for (int i : loop) sum += curve.nearest(mesh.vertices.row(i)).second;
            return sum;
        };
        const auto curve =
            std::min_element(curves.begin(), curves.end(),
                             [&](const Curve& c, const Curve& d) { return gap(c) < gap(d); });
        restore_border(mesh.vertices, loop, *curve,
                       kept_places[static_cast<size_t>(curve - curves.begin())]);
    }
}

/// Moves inner vertices towards the area-weighted mean of the centroids of their triangles and back
/// onto the surface.
void smooth_inside(TriMesh& mesh, const std::vector<char>& fixed, const SurfaceDistance& surface) {
    Points moment = Points::Zero(mesh.vertices.rows(), 3);
    VectorX weight = VectorX::Zero(mesh.vertices.rows());
    const VectorX areas = face_area_vectors(mesh.vertices, mesh.faces).rowwise().norm();
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        const Eigen::RowVector3d centroid =
            (mesh.vertices.row(mesh.faces(f, 0)) + mesh.vertices.row(mesh.faces(f, 1)) +
             mesh.vertices.row(mesh.faces(f, 2))) /
            3.0;
        for (int c = 0; c < 3; ++c) {
            moment.row(mesh.faces(f, c)) += areas[f] * centroid;
            weight[mesh.faces(f, c)] += areas[f];
        }
    }
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i)
        if (!fixed[static_cast<size_t>(i)])
            mesh.vertices.row(i) =
                surface.nearest(moment.row(i).transpose() / weight[i]).point.transpose();
}

/// Vertices on borders and folds: smoothing would draw them inwards.
std::vector<char> edge_flags(const TriMesh& mesh, Folds keep) {
    std::vector<char> flags(static_cast<size_t>(mesh.vertices.rows()), 0);
    for (const std::vector<int>& loop : boundary_loops(mesh.faces))
        for (int i : loop) flags[static_cast<size_t>(i)] = 1;
    if (keep == Folds::smooth) return flags;
    for (const auto& fold : folds(mesh))
        for (int i : fold) flags[static_cast<size_t>(i)] = 1;
    return flags;
}

/// Those of the vertices that are not too near to an earlier one.
std::vector<int> spaced(const Points& vertices, const std::vector<int>& kept, double distance) {
    std::vector<int> result;
    for (const int i : kept) {
        const bool near = std::any_of(result.begin(), result.end(), [&](int other) {
            return (vertices.row(other) - vertices.row(i)).norm() < distance;
        });
        if (!near) result.push_back(i);
    }
    return result;
}

/// Moves the nearest vertex that is not fixed yet to each of `kept` that is not on a border, if it
/// is nearer than `reach`, and fixes it.
void keep_inside(TriMesh& mesh, const TriMesh& original, const std::vector<int>& kept, double reach,
                 std::vector<char>& fixed) {
    const std::vector<char> border = edge_flags(original, Folds::smooth);
    for (const int i : kept) {
        if (border[static_cast<size_t>(i)]) continue;
        Eigen::Index nearest = -1;
        double best = reach;
        for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
            const double distance = (mesh.vertices.row(v) - original.vertices.row(i)).norm();
            if (fixed[static_cast<size_t>(v)] || !(distance < best)) continue;
            best = distance;
            nearest = v;
        }
        if (nearest < 0) continue;
        mesh.vertices.row(nearest) = original.vertices.row(i);
        fixed[static_cast<size_t>(nearest)] = 1;
    }
}

}  // namespace

TriMesh remesh(const TriMesh& surface, int target_vertices, const std::vector<int>& kept,
               Folds keep) {
    const SurfaceDistance original(surface);
    const double ideal = std::sqrt(2.0 / std::sqrt(3.0) * area(surface) / target_vertices);
    // The remesher's edges come out shorter than asked: 10 % more meets the number at once, mostly.
    double edge_length = 1.1 * ideal;
    TriMesh mesh;
    for (int attempt = 0; attempt < 8; ++attempt) {
        mesh = isotropic(surface, edge_length, 8, keep);
        const double ratio = static_cast<double>(mesh.vertices.rows()) / target_vertices;
        if (std::abs(ratio - 1.0) < 0.015) break;
        edge_length *= std::sqrt(ratio);
    }
    const std::vector<int> apart = spaced(surface.vertices, kept, kKeptSpacing * ideal);
    // Of the mesh as it is: where its border has slid, restoring that turns faces over, which look
    // like folds and would be kept.
    std::vector<char> fixed = edge_flags(mesh, keep);
    restore_borders(mesh, surface, apart);
    keep_inside(mesh, surface, apart, ideal, fixed);
    TriMesh best;
    double best_angle = -1.0;
    for (int round = 0; round < kSmoothingRounds && best_angle < kGoodGarmentAngle; ++round) {
        smooth_inside(mesh, fixed, original);
        flip_edges(mesh);
        const double angle = smallest_angle(mesh);
        if (round < kFirstRounds || angle < best_angle) continue;
        best = mesh;
        best_angle = angle;
    }
    return best;
}

}  // namespace cloth
