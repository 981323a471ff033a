#include "data/body/skin_weights.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "data/body/segment_grid.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// Bones at nearly the same distance share a vertex, so that a joint's two sides meet halfway.
constexpr double same_distance = 1.0001;

Vec3 closest_on_segment(const BoneSegment& bone, const Vec3& x) {
    const Vec3 along = bone.to - bone.from;
    const double length2 = along.squaredNorm();
    const double s = length2 > 0.0 ? (x - bone.from).dot(along) / length2 : 0.0;
    return bone.from + std::clamp(s, 0.0, 1.0) * along;
}

/// Cotangent Laplacian, positive semi-definite. Negative weights (obtuse triangles) are dropped so
/// that the solution keeps to [0, 1].
SparseMatrix cotangent_laplacian(const TriMesh& mesh) {
    Triplets entries;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        for (int corner = 0; corner < 3; ++corner) {
            const int i = mesh.faces(f, (corner + 1) % 3), j = mesh.faces(f, (corner + 2) % 3);
            const int k = mesh.faces(f, corner);
            const Vec3 a = (mesh.vertices.row(i) - mesh.vertices.row(k)).transpose();
            const Vec3 b = (mesh.vertices.row(j) - mesh.vertices.row(k)).transpose();
            const double cotangent = a.dot(b) / std::max(a.cross(b).norm(), 1e-14);
            const double weight = 0.5 * std::clamp(cotangent, 1e-3, 1e3);
            entries.emplace_back(i, j, -weight);
            entries.emplace_back(j, i, -weight);
            entries.emplace_back(i, i, weight);
            entries.emplace_back(j, j, weight);
        }
    const Eigen::Index n = mesh.vertices.rows();
    SparseMatrix laplacian(n, n);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    return laplacian;
}

/// A third of the faces around each vertex (|V|, m^2).
VectorX vertex_areas(const TriMesh& mesh) {
    const Points area_vectors = face_area_vectors(mesh.vertices, mesh.faces);
    VectorX areas = VectorX::Zero(mesh.vertices.rows());
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        for (int corner = 0; corner < 3; ++corner)
            areas[mesh.faces(f, corner)] += area_vectors.row(f).norm() / 3.0;
    return areas;
}

/// The heat that flows into each vertex from its nearest visible bones.
struct HeatSources {
    VectorX rate;            ///< |V|: heat / d^2
    Eigen::MatrixXd shares;  ///< |V| x |joints|: p
};

/// Tells which bones a vertex of the skin sees.
class BoneView {
 public:
    explicit BoneView(const TriMesh& skin)
        : m_skin(skin),
          m_normals(vertex_normals(skin.vertices, skin.faces)),
          m_grid(skin.vertices, skin.faces, grid_cell) {}

    /// Distances to the bones that vertex i sees, infinite to the others; returns the smallest.
    /// Where it sees none (inside the mouth) it is given all.
    double measure(Eigen::Index i, const std::vector<BoneSegment>& bones,
                   std::vector<double>& distances) const {
        for (bool ask_visibility : {true, false}) {
            double nearest = unseen;
            for (size_t b = 0; b < bones.size(); ++b) {
                const Vec3 x = m_skin.vertices.row(i);
                const Vec3 target = closest_on_segment(bones[b], x);
                const double distance = (target - x).norm();
                // Only bones that may be nearest matter; they spare most of the rays.
                const bool counts =
                    distance <= nearest * same_distance && (!ask_visibility || sees(i, x, target));
                distances[b] = counts ? distance : unseen;
                nearest = std::min(nearest, distances[b]);
            }
            if (nearest < unseen) return nearest;
        }
        return unseen;
    }

 private:
    static constexpr double unseen = std::numeric_limits<double>::infinity();
    static constexpr double grid_cell = 0.02;  // m

    /// The way starts inwards and does not leave the body. Both ends are left out: the vertex's own
    /// faces, and the skin that the tips of bones reach into.
    bool sees(Eigen::Index i, const Vec3& x, const Vec3& target) const {
        const Vec3 way = target - x;
        return way.dot(m_normals.row(i)) < 0.0 && !m_grid.hits(x + 0.01 * way, x + 0.9 * way);
    }

    const TriMesh& m_skin;
    Points m_normals;
    SegmentGrid m_grid;
};

HeatSources find_sources(const TriMesh& skin, const std::vector<BoneSegment>& bones,
                         int joint_count, double heat) {
    const Eigen::Index n = skin.vertices.rows();
    const BoneView view(skin);
    HeatSources sources{VectorX::Zero(n), Eigen::MatrixXd::Zero(n, joint_count)};
    std::vector<double> distances(bones.size());
    for (Eigen::Index i = 0; i < n; ++i) {
        const double nearest = view.measure(i, bones, distances);
        int sharing = 0;
        for (double distance : distances) sharing += distance <= nearest * same_distance;
        for (size_t b = 0; b < bones.size(); ++b)
            if (distances[b] <= nearest * same_distance)
                sources.shares(i, bones[b].joint) += 1.0 / sharing;
        sources.rate[i] = heat / std::max(nearest * nearest, 1e-8);
    }
    return sources;
}

}  // namespace

double SkinWeights::at(int vertex, int joint) const {
    for (int k = begin[vertex]; k < begin[vertex + 1]; ++k)
        if (joints[k] == joint) return values[k];
    return 0.0;
}

std::vector<int> SkinWeights::dominant_joints() const {
    std::vector<int> dominant(vertex_count());
    for (int i = 0; i < vertex_count(); ++i) dominant[i] = joints[begin[i]];
    return dominant;
}

SkinWeights sparse_weights(const Eigen::MatrixXd& dense, int max_influences, double threshold) {
    SkinWeights result;
    result.begin.push_back(0);
    std::vector<int> order(dense.cols());
    for (Eigen::Index i = 0; i < dense.rows(); ++i) {
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(),
                         [&](int a, int b) { return dense(i, a) > dense(i, b); });
        double sum = 0.0;
        int count = 0;
        while (count < std::min<int>(max_influences, static_cast<int>(order.size())) &&
               (count == 0 || dense(i, order[count]) > threshold * dense.row(i).sum()))
            sum += dense(i, order[count++]);
        for (int k = 0; k < count; ++k) {
            result.joints.push_back(order[k]);
            result.values.push_back(dense(i, order[k]) / sum);
        }
        result.begin.push_back(static_cast<int>(result.joints.size()));
    }
    return result;
}

SkinWeights heat_weights(const TriMesh& skin, const std::vector<BoneSegment>& bones,
                         int joint_count, const HeatWeightSettings& settings) {
    check_range("HeatWeightSettings.heat", settings.heat, 0.1, 10.0);
    check_range("HeatWeightSettings.max_influences", settings.max_influences, 1, 8);
    check_range("HeatWeightSettings.threshold", settings.threshold, 0.0, 0.1);
    if (skin.faces.rows() == 0 || bones.empty())
        throw ArgumentError("skin", "has no faces or there are no bones", "give both");
    const HeatSources sources = find_sources(skin, bones, joint_count, settings.heat);
    const VectorX rates = vertex_areas(skin).cwiseProduct(sources.rate);
    SparseMatrix matrix = cotangent_laplacian(skin);
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) matrix.coeffRef(i, i) += rates[i];
    const Eigen::SimplicialLDLT<SparseMatrix> solver(matrix);
    if (solver.info() != Eigen::Success || solver.vectorD().minCoeff() <= 0.0)
        throw ArgumentError("skin", "the heat equation cannot be solved on it",
                            "remove faces without area and vertices that are not finite");
    const Eigen::MatrixXd dense = solver.solve(rates.asDiagonal() * sources.shares);
    return sparse_weights(dense.cwiseMax(0.0), settings.max_influences, settings.threshold);
}

}  // namespace cloth
