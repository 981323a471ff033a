#include "data/body/garment_sides.h"

#include <algorithm>

#include "data/core/mesh_pieces.h"

namespace cloth {

namespace {

constexpr double thickest = 0.02;        // of a shell (m)
constexpr double least_inner = 0.2;      // of a shell's area
constexpr double mostly = 0.7;           // of the inner side that has the outer one near it
constexpr double rim_outwardness = 0.5;  // of the faces between the sides, at most
constexpr double lining_gap = 0.015;     // (m)
constexpr double lining_share = 0.85;

Points middles(const TriMesh& mesh) {
    Points result(mesh.faces.rows(), 3);
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        result.row(f) = (mesh.vertices.row(mesh.faces(f, 0)) + mesh.vertices.row(mesh.faces(f, 1)) +
                         mesh.vertices.row(mesh.faces(f, 2))) /
                        3.0;
    return result;
}

VectorX areas_of(const TriMesh& mesh) {
    return face_area_vectors(mesh.vertices, mesh.faces).rowwise().norm();
}

double median(std::vector<double> values) {
    if (values.empty()) return 0.0;
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

/// The rim joins the sides: it looks along the cloth, and touches the inner side.
void add_rim(const TriMesh& garment, const VectorX& outward, std::vector<char>& is_inner) {
    std::vector<char> touches(static_cast<size_t>(garment.vertices.rows()), 0);
    for (Eigen::Index f = 0; f < garment.faces.rows(); ++f)
        if (is_inner[static_cast<size_t>(f)])
            for (int c = 0; c < 3; ++c) touches[static_cast<size_t>(garment.faces(f, c))] = 1;
    for (Eigen::Index f = 0; f < garment.faces.rows(); ++f) {
        if (outward[f] > rim_outwardness) continue;
        for (int c = 0; c < 3; ++c)
            if (touches[static_cast<size_t>(garment.faces(f, c))])
                is_inner[static_cast<size_t>(f)] = 1;
    }
}

/// The part of a piece's area that is near to another surface, and the median distance of it.
std::pair<double, double> covered(const TriMesh& piece, const SurfaceDistance& by) {
    const Points at = middles(piece);
    const VectorX area = areas_of(piece);
    double near = 0.0;
    std::vector<double> distances;
    for (Eigen::Index f = 0; f < at.rows(); ++f)
        if (const auto found = by.nearest_within(lining_gap, at.row(f))) {
            near += area[f];
            distances.push_back((found->point - at.row(f).transpose()).norm());
        }
    return {near / area.sum(), median(distances)};
}

double mean_distance(const TriMesh& mesh, const SurfaceDistance& skin) {
    const Points at = middles(mesh);
    double sum = 0.0;
    for (Eigen::Index f = 0; f < at.rows(); ++f) sum += skin.nearest(at.row(f)).distance;
    return sum / static_cast<double>(at.rows());
}

}  // namespace

VectorX outwardness(const TriMesh& garment, const SurfaceDistance& skin) {
    const Points at = middles(garment), normals = face_normals(garment.vertices, garment.faces);
    VectorX result(at.rows());
    for (Eigen::Index f = 0; f < at.rows(); ++f) {
        const NearestPoint near = skin.nearest(at.row(f));
        const Vec3 away = at.row(f).transpose() - near.point;
        constexpr double touching = 1e-6;  // (m): there the skin's normal says it better
        const Vec3 out =
            std::abs(near.distance) > touching ? Vec3(away / near.distance) : near.normal;
        result[f] = normals.row(f).dot(out);
    }
    return result;
}

int turn_outwards(TriMesh& garment, const SurfaceDistance& skin) {
    const std::vector<int> pieces = face_pieces(garment.faces);
    int turned = 0;
    for (int k = 0; k < piece_count(pieces); ++k) {
        const TriMesh piece = piece_of(garment, pieces, k);
        const bool inwards = border_share(piece.faces) == 0.0
                                 ? signed_volume(piece) < 0.0
                                 : outwardness(piece, skin).dot(areas_of(piece)) < 0.0;
        if (!inwards) continue;
        ++turned;
        for (Eigen::Index f = 0; f < garment.faces.rows(); ++f)
            if (pieces[static_cast<size_t>(f)] == k)
                std::swap(garment.faces(f, 1), garment.faces(f, 2));
    }
    return turned;
}

std::optional<InnerSide> find_inner_side(const TriMesh& garment, const SurfaceDistance& skin) {
    const VectorX outward = outwardness(garment, skin), area = areas_of(garment);
    InnerSide side;
    std::vector<char> is_outer;
    double inner_area = 0.0;
    for (Eigen::Index f = 0; f < outward.size(); ++f) {
        const bool inner = outward[f] < 0.0;
        side.is_inner.push_back(inner);
        is_outer.push_back(!inner);
        inner_area += inner ? area[f] : 0.0;
    }
    if (inner_area < least_inner * area.sum() || inner_area == area.sum()) return std::nullopt;
    const SurfaceDistance outer(keep_faces(garment, is_outer));
    const Points at = middles(garment);
    double near = 0.0;
    std::vector<double> distances;
    for (Eigen::Index f = 0; f < outward.size(); ++f) {
        if (!side.is_inner[static_cast<size_t>(f)]) continue;
        const auto found = outer.nearest_within(thickest, at.row(f));
        if (!found) continue;
        near += area[f];
        distances.push_back((found->point - at.row(f).transpose()).norm());
    }
    if (near < mostly * inner_area) return std::nullopt;
    side.thickness = median(distances);
    add_rim(garment, outward, side.is_inner);
    for (Eigen::Index f = 0; f < outward.size(); ++f)
        if (side.is_inner[static_cast<size_t>(f)]) side.share += area[f] / area.sum();
    return side;
}

std::vector<Lining> find_linings(const TriMesh& garment, const std::vector<int>& face_pieces,
                                 const SurfaceDistance& skin) {
    std::vector<TriMesh> pieces;
    std::vector<double> heights;  // above the skin
    for (int k = 0; k < piece_count(face_pieces); ++k) {
        pieces.push_back(piece_of(garment, face_pieces, k));
        heights.push_back(mean_distance(pieces.back(), skin));
    }
    std::vector<Lining> found;
    for (size_t i = 0; i < pieces.size(); ++i)
        for (size_t j = 0; j < pieces.size(); ++j) {
            if (heights[i] > heights[j] || (heights[i] == heights[j] && i >= j)) continue;
            const auto [share, gap] = covered(pieces[i], SurfaceDistance(pieces[j]));
            if (share < lining_share) continue;
            if (covered(pieces[j], SurfaceDistance(pieces[i])).first < lining_share) continue;
            found.push_back({static_cast<int>(i), static_cast<int>(j), gap});
        }
    return found;
}

}  // namespace cloth
