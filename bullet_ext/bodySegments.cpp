#include "bullet_ext/bodySegments.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "bullet_ext/bulletShapes.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

constexpr double kFits = 2e-3;       ///< a hull that stands off less is not cut (m)
constexpr double kThickness = 0.04;  ///< thinner slabs are not cut (m)

/// A piece that may still be cut: the vertices it owns, and the segment it would be.
struct Piece {
    std::vector<int> owned;
    BodySegment segment;
    Vec3 axis = Vec3::UnitY();  ///< cuts are across it
    double standoff = 0.0;      ///< (m)
    bool final = false;         ///< cannot be cut
};

class Cutter {
 public:
    explicit Cutter(const TriMesh& rest)
        : m_rest(rest), m_neighbours(static_cast<size_t>(rest.vertices.rows())) {
        for (const auto& [a, b] : undirected_edges(rest.faces)) {
            m_neighbours[static_cast<size_t>(a)].push_back(b);
            m_neighbours[static_cast<size_t>(b)].push_back(a);
        }
    }

    Piece piece(int joint, const Vec3& axis, std::vector<int> owned) const {
        Piece piece;
        piece.owned = std::move(owned);
        piece.axis = axis;
        piece.segment.joint = joint;
        piece.segment.vertices = withNeighbours(piece.owned);
        piece.segment.rest = m_rest.vertices(piece.segment.vertices, Eigen::all);
        piece.segment.hull_points_rest = convexHull(piece.segment.rest).vertices;
        piece.standoff = hull_standoff(piece.segment);
        return piece;
    }

    /// Cuts a piece in the middle into itself and the returned one; nothing if it is too small.
    std::optional<Piece> cut(Piece& whole) const {
        const VectorX along = Points(m_rest.vertices(whole.owned, Eigen::all)) * whole.axis;
        const double low = along.minCoeff(), high = along.maxCoeff();
        std::vector<int> below, above;
        for (size_t i = 0; i < whole.owned.size(); ++i)
            (along[static_cast<Eigen::Index>(i)] < 0.5 * (low + high) ? below : above)
                .push_back(whole.owned[i]);
        constexpr size_t kSmallest = 4;
        whole.final = high - low < kThickness || std::min(below.size(), above.size()) < kSmallest;
        if (whole.final) return std::nullopt;
        const int joint = whole.segment.joint;
        const Vec3 axis = whole.axis;
        whole = piece(joint, axis, std::move(below));
        return piece(joint, axis, std::move(above));
    }

    /// The principal axis across which four slabs fit best.
    Vec3 bestAxis(int joint, const std::vector<int>& owned) const {
        const Points x = m_rest.vertices(owned, Eigen::all);
        const Points spread = x.rowwise() - x.colwise().mean();
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread.transpose() * spread);
        Vec3 best = axes.eigenvectors().col(2);
        double least = std::numeric_limits<double>::infinity();
        for (int a = 2; a >= 0; --a) {
            const Vec3 axis = axes.eigenvectors().col(a);
            const double standoff = standoffOfFour(piece(joint, axis, owned));
            if (standoff < 0.9 * least) {  // the longest axis, unless another is clearly better
                least = standoff;
                best = axis;
            }
        }
        return best;
    }

 private:
    double standoffOfFour(Piece whole) const {
        std::vector<Piece> slabs = {std::move(whole)};
        for (int round = 0; round < 2; ++round)
            for (size_t i = 0, count = slabs.size(); i < count; ++i)
                if (auto other = cut(slabs[i])) slabs.push_back(std::move(*other));
        double standoff = 0.0;
        for (const Piece& slab : slabs) standoff = std::max(standoff, slab.standoff);
        return standoff;
    }

    std::vector<int> withNeighbours(const std::vector<int>& owned) const {
        std::vector<int> all = owned;
        for (int v : owned)
            all.insert(all.end(), m_neighbours[static_cast<size_t>(v)].begin(),
                       m_neighbours[static_cast<size_t>(v)].end());
        std::sort(all.begin(), all.end());
        all.erase(std::unique(all.begin(), all.end()), all.end());
        return all;
    }

    const TriMesh& m_rest;
    std::vector<std::vector<int>> m_neighbours;
};

/// The piece to cut next: the one whose hull stands off most; pieces.end() if none can be cut.
std::vector<Piece>::iterator worstPiece(std::vector<Piece>& pieces) {
    auto worst = pieces.end();
    for (auto it = pieces.begin(); it != pieces.end(); ++it)
        if (!it->final && it->standoff > kFits &&
            (worst == pieces.end() || it->standoff > worst->standoff))
            worst = it;
    return worst;
}

void validate(const TriMesh& rest, const std::vector<int>& dominant_joint, int target_count) {
    validate_mesh("body", rest);
    if (dominant_joint.size() != static_cast<size_t>(rest.vertices.rows()))
        throw ArgumentError("dominant_joint",
                            "has " + std::to_string(dominant_joint.size()) + " entries for " +
                                std::to_string(rest.vertices.rows()) + " vertices",
                            "give the joint of every vertex");
    if (target_count < 1 || target_count > 1000)
        throw ArgumentError("target_count", "is " + std::to_string(target_count),
                            "use 1 to 1000 pieces; 70 suit a human body");
}

}  // namespace

std::vector<BodySegment> segment_body(const TriMesh& rest, const std::vector<int>& dominant_joint,
                                      int target_count) {
    validate(rest, dominant_joint, target_count);
    std::map<int, std::vector<int>> owned;
    for (size_t v = 0; v < dominant_joint.size(); ++v)
        owned[dominant_joint[v]].push_back(static_cast<int>(v));
    const Cutter cutter(rest);
    std::vector<Piece> pieces;
    for (auto& [joint, vertices] : owned)
        pieces.push_back(cutter.piece(joint, cutter.bestAxis(joint, vertices), vertices));
    while (pieces.size() < static_cast<size_t>(target_count)) {
        const auto worst = worstPiece(pieces);
        if (worst == pieces.end()) break;
        if (auto other = cutter.cut(*worst)) pieces.push_back(std::move(*other));
    }
    std::vector<BodySegment> segments;
    for (Piece& piece : pieces)
        if (piece.segment.hull_points_rest.rows() >= 4)
            segments.push_back(std::move(piece.segment));
    return segments;
}

double hull_standoff(const BodySegment& segment) {
    const TriMesh hull = convexHull(segment.rest);
    const Points normals = face_normals(hull.vertices, hull.faces);
    double standoff = 0.0;
    for (Eigen::Index i = 0; i < segment.rest.rows(); ++i) {
        double depth = std::numeric_limits<double>::infinity();
        for (Eigen::Index f = 0; f < hull.faces.rows(); ++f)
            depth = std::min(
                depth,
                (hull.vertices.row(hull.faces(f, 0)) - segment.rest.row(i)).dot(normals.row(f)));
        if (hull.faces.rows() > 0) standoff = std::max(standoff, depth);
    }
    return standoff;
}

}  // namespace cloth
