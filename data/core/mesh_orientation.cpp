#include "data/core/mesh_orientation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <vector>

#include "data/core/mesh_pieces.h"

namespace cloth {

namespace {

/// An edge as one of its faces runs through it.
struct FaceEdge {
    int low, high;  ///< its vertices
    int face;
    bool ascending;  ///< from low to high

    bool joins_as(const FaceEdge& other) const { return low == other.low && high == other.high; }
    bool operator<(const FaceEdge& other) const {
        return std::array<int, 3>{low, high, face} <
               std::array<int, 3>{other.low, other.high, other.face};
    }
};

bool has_three_corners(const Faces& faces, Eigen::Index f) {
    return faces(f, 0) != faces(f, 1) && faces(f, 1) != faces(f, 2) && faces(f, 2) != faces(f, 0);
}

std::vector<FaceEdge> sorted_face_edges(const Faces& faces) {
    std::vector<FaceEdge> edges;
    edges.reserve(static_cast<size_t>(faces.size()));
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        if (!has_three_corners(faces, f)) continue;
        for (int c = 0; c < 3; ++c) {
            const int a = faces(f, c), b = faces(f, (c + 1) % 3);
            edges.push_back({std::min(a, b), std::max(a, b), static_cast<int>(f), a < b});
        }
    }
    std::sort(edges.begin(), edges.end());
    return edges;
}

/// Calls visit(first, end) for the faces of each edge.
template <typename Visit>
void for_each_edge(const std::vector<FaceEdge>& edges, const Visit& visit) {
    for (auto first = edges.begin(); first != edges.end();) {
        const auto end = std::find_if(first, edges.end(),
                                      [&](const FaceEdge& edge) { return !edge.joins_as(*first); });
        visit(first, end);
        first = end;
    }
}

Faces welded_at_open_edges(const Points& x, const Faces& faces,
                           const std::vector<FaceEdge>& edges) {
    std::vector<char> is_open(static_cast<size_t>(x.rows()), 0);
    for_each_edge(edges, [&](auto first, auto end) {
        if (end - first == 1)
            is_open[static_cast<size_t>(first->low)] = is_open[static_cast<size_t>(first->high)] =
                1;
    });
    std::vector<int> target(is_open.size()), open;
    std::iota(target.begin(), target.end(), 0);
    std::copy_if(target.begin(), target.end(), std::back_inserter(open),
                 [&](int i) { return is_open[static_cast<size_t>(i)]; });
    const auto place = [&](int i) { return std::array<double, 3>{x(i, 0), x(i, 1), x(i, 2)}; };
    std::stable_sort(open.begin(), open.end(), [&](int a, int b) { return place(a) < place(b); });
    for (size_t k = 1; k < open.size(); ++k)
        if (place(open[k]) == place(open[k - 1]))
            target[static_cast<size_t>(open[k])] = target[static_cast<size_t>(open[k - 1])];
    return faces.unaryExpr([&](int i) { return target[static_cast<size_t>(i)]; });
}

void find_turned(const Faces& faces, const std::vector<FaceEdge>& edges,
                 OrientationFaults& faults) {
    std::vector<int> count(static_cast<size_t>(faces.rows()), 0);
    for_each_edge(edges, [&](auto first, auto end) {
        if (end - first != 2 || first->ascending != (first + 1)->ascending) return;
        ++faults.turned_edges;
        ++count[static_cast<size_t>(first->face)];
        ++count[static_cast<size_t>((first + 1)->face)];
    });
    if (faults.turned_edges > 0)
        faults.turned_face =
            static_cast<int>(std::max_element(count.begin(), count.end()) - count.begin());
}

void find_repeated(const Faces& faces, OrientationFaults& faults) {
    struct Corners {
        std::array<int, 3> ordered;
        bool is_even;  ///< the order is that of the face
        int face;
    };
    std::vector<Corners> all;
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        if (!has_three_corners(faces, f)) continue;
        const std::array<int, 3> c = {faces(f, 0), faces(f, 1), faces(f, 2)};
        const int swaps = (c[0] > c[1]) + (c[1] > c[2]) + (c[0] > c[2]);
        all.push_back({c, swaps % 2 == 0, static_cast<int>(f)});
        std::sort(all.back().ordered.begin(), all.back().ordered.end());
    }
    std::sort(all.begin(), all.end(), [](const Corners& a, const Corners& b) {
        return a.ordered != b.ordered ? a.ordered < b.ordered : a.face < b.face;
    });
    for (size_t k = 1; k < all.size(); ++k) {
        if (all[k].ordered != all[k - 1].ordered || all[k].is_even == all[k - 1].is_even) continue;
        ++faults.repeated_faces;
        if (faults.repeated_face < 0 || all[k].face < faults.repeated_face)
            faults.repeated_face = all[k].face;
    }
}

struct PieceMeasure {
    double volume = 0.0, area = 0.0;  ///< m^3, m^2
    int edges = 0, open_edges = 0;
    int first_face = -1;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = -low;

    bool is_closed() const { return open_edges < 0.05 * edges; }
    /// A flat or crumpled one has a volume of either sign. Of a ball it is 0.09 of this measure.
    bool looks_inwards() const { return is_closed() && volume < -1e-3 * std::pow(area, 1.5); }
    bool is_within(const PieceMeasure& other) const {
        return (low.array() >= other.low.array()).all() &&
               (high.array() <= other.high.array()).all();
    }
};

std::vector<PieceMeasure> measure_pieces(const Points& x, const Faces& faces,
                                         const std::vector<FaceEdge>& edges) {
    const std::vector<int> piece_of = face_pieces(faces);
    std::vector<PieceMeasure> pieces(static_cast<size_t>(piece_count(piece_of)));
    const auto piece = [&](int face) -> PieceMeasure& {
        return pieces[static_cast<size_t>(piece_of[static_cast<size_t>(face)])];
    };
    for (int f = 0; f < static_cast<int>(faces.rows()); ++f)
        for (int c = 0; c < 3; ++c) {
            const Vec3 corner = x.row(faces(f, c));
            piece(f).low = piece(f).low.cwiseMin(corner);
            piece(f).high = piece(f).high.cwiseMax(corner);
        }
    for (int f = 0; f < static_cast<int>(faces.rows()); ++f) {
        PieceMeasure& of = piece(f);
        if (of.first_face < 0) of.first_face = f;
        const Vec3 middle = 0.5 * (of.low + of.high);
        const Vec3 a = x.row(faces(f, 0)), b = x.row(faces(f, 1)), c = x.row(faces(f, 2));
        of.volume += (a - middle).dot((b - middle).cross(c - middle)) / 6.0;
        of.area += 0.5 * (b - a).cross(c - a).norm();
    }
    for_each_edge(edges, [&](auto first, auto end) {
        ++piece(first->face).edges;
        piece(first->face).open_edges += end - first == 1;
    });
    return pieces;
}

void find_inside_out(const std::vector<PieceMeasure>& pieces, OrientationFaults& faults) {
    double all = 0.0;
    for (const PieceMeasure& piece : pieces) all += std::abs(piece.volume);
    const auto is_inside_out = [&](const PieceMeasure& piece) {
        if (!piece.looks_inwards() || piece.volume > -0.1 * all) return false;
        return std::none_of(pieces.begin(), pieces.end(), [&](const PieceMeasure& other) {
            return &other != &piece && piece.is_within(other);
        });
    };
    const auto found = std::find_if(pieces.begin(), pieces.end(), is_inside_out);
    if (found != pieces.end()) faults.inside_out_face = found->first_face;
}

}  // namespace

OrientationFaults orientation_faults(const Points& x, const Faces& faces) {
    OrientationFaults faults;
    std::vector<FaceEdge> edges = sorted_face_edges(faces);
    const Faces welded = welded_at_open_edges(x, faces, edges);
    if (welded != faces) edges = sorted_face_edges(welded);
    find_turned(welded, edges, faults);
    find_repeated(welded, faults);
    find_inside_out(measure_pieces(x, welded, edges), faults);
    return faults;
}

}  // namespace cloth
