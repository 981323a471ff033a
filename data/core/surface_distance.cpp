#include "data/core/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "data/core/triangle.h"

namespace cloth {

namespace {

struct Box {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = Vec3::Constant(-std::numeric_limits<double>::infinity());

    void add(const Vec3& p) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    double squared_distance(const Vec3& p) const {
        return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
    }
};

/// Inner nodes have their left child next to them; leaves hold a range of the face order.
struct Node {
    Box box;
    int right = -1;
    int first = 0;
    int count = 0;
};

constexpr int kLeafFaces = 4;

}  // namespace

struct SurfaceDistance::Impl {
    TriMesh surface;
    Points normals_of_faces;
    Points normals_of_vertices;
    std::vector<std::array<Vec3, 3>> normals_of_edges;  ///< by face and opposite corner
    std::vector<int> order;
    std::vector<Node> nodes;

    Vec3 corner(int face, int c) const { return surface.vertices.row(surface.faces(face, c)); }

    void build_normals() {
        const Faces& faces = surface.faces;
        normals_of_faces = face_normals(surface.vertices, faces);
        normals_of_vertices = Points::Zero(surface.vertices.rows(), 3);
        std::map<std::pair<int, int>, Vec3> edges;
        for (int f = 0; f < faces.rows(); ++f)
            for (int c = 0; c < 3; ++c) {
                const Vec3 u = corner(f, (c + 1) % 3) - corner(f, c);
                const Vec3 v = corner(f, (c + 2) % 3) - corner(f, c);
                normals_of_vertices.row(faces(f, c)) +=
                    angle_between(u, v) * normals_of_faces.row(f);
                edges.try_emplace(edge_key(f, c), Vec3::Zero()).first->second +=
                    normals_of_faces.row(f).transpose();
            }
        normals_of_vertices.rowwise().normalize();
        normals_of_edges.resize(static_cast<size_t>(faces.rows()));
        for (int f = 0; f < faces.rows(); ++f)
            for (int c = 0; c < 3; ++c)
                normals_of_edges[static_cast<size_t>(f)][static_cast<size_t>(c)] =
                    edges.at(edge_key(f, c)).normalized();
    }

    std::pair<int, int> edge_key(int f, int opposite) const {
        return std::minmax(
            {surface.faces(f, (opposite + 1) % 3), surface.faces(f, (opposite + 2) % 3)});
    }

    Vec3 centre(int f) const { return (corner(f, 0) + corner(f, 1) + corner(f, 2)) / 3.0; }

    void build_node(int first, int count) {
        const size_t index = nodes.size();
        nodes.emplace_back();
        Box box;
        for (int i = first; i < first + count; ++i)
            for (int c = 0; c < 3; ++c) box.add(corner(order[static_cast<size_t>(i)], c));
        nodes[index].box = box;
        nodes[index].first = first;
        nodes[index].count = count;
        if (count <= kLeafFaces) return;
        Eigen::Index axis = 0;
        (box.high - box.low).maxCoeff(&axis);
        const auto begin = order.begin() + first;
        std::nth_element(begin, begin + count / 2, begin + count, [&](int a, int b) {
            return std::make_pair(centre(a)[axis], a) < std::make_pair(centre(b)[axis], b);
        });
        build_node(first, count / 2);
        nodes[index].right = static_cast<int>(nodes.size());
        build_node(first + count / 2, count - count / 2);
    }

    /// Looks for a face nearer than the squared distance `best`.
    void search(size_t index, const Vec3& p, double& best, int& face, Vec3& weights) const {
        const Node& node = nodes[index];
        if (node.right < 0) {
            for (int i = node.first; i < node.first + node.count; ++i) {
                const int f = order[static_cast<size_t>(i)];
                const TriangleHit hit =
                    closest_on_triangle(p, corner(f, 0), corner(f, 1), corner(f, 2));
                if (hit.squared < best || (hit.squared == best && f < face)) {
                    best = hit.squared;
                    face = f;
                    weights = hit.barycentric;
                }
            }
            return;
        }
        size_t near = index + 1, far = static_cast<size_t>(node.right);
        double near_gap = nodes[near].box.squared_distance(p);
        double far_gap = nodes[far].box.squared_distance(p);
        if (far_gap < near_gap) {
            std::swap(near, far);
            std::swap(near_gap, far_gap);
        }
        if (near_gap <= best) search(near, p, best, face, weights);
        if (far_gap <= best) search(far, p, best, face, weights);
    }

    /// The normal of the corner, edge or face that a point with these weights lies on.
    Vec3 normal(int f, const Vec3& weights) const {
        Eigen::Index largest = 0, least = 0;
        weights.maxCoeff(&largest);
        weights.minCoeff(&least);
        const auto zeros = (weights.array() == 0.0).count();
        if (zeros == 2) return normals_of_vertices.row(surface.faces(f, largest));
        if (zeros == 1) return normals_of_edges[static_cast<size_t>(f)][static_cast<size_t>(least)];
        return normals_of_faces.row(f);
    }
};

SurfaceDistance::SurfaceDistance(TriMesh surface) : m_impl(std::make_unique<Impl>()) {
    validate_mesh("surface", surface);
    m_impl->surface = std::move(surface);
    m_impl->build_normals();
    const int faces = static_cast<int>(m_impl->surface.faces.rows());
    m_impl->order.resize(static_cast<size_t>(faces));
    std::iota(m_impl->order.begin(), m_impl->order.end(), 0);
    m_impl->build_node(0, faces);
}

SurfaceDistance::~SurfaceDistance() = default;
SurfaceDistance::SurfaceDistance(SurfaceDistance&&) noexcept = default;

const TriMesh& SurfaceDistance::surface() const {
    return m_impl->surface;
}

NearestPoint SurfaceDistance::nearest(const Vec3& p) const {
    return nearest_within(std::numeric_limits<double>::infinity(), p).value();
}

std::optional<NearestPoint> SurfaceDistance::nearest_within(double radius, const Vec3& p) const {
    constexpr int none = -1;
    NearestPoint result;
    result.face = none;
    double best = radius * radius;
    m_impl->search(0, p, best, result.face, result.weights);
    if (result.face == none) return std::nullopt;
    for (int c = 0; c < 3; ++c) result.point += result.weights[c] * m_impl->corner(result.face, c);
    result.normal = m_impl->normal(result.face, result.weights);
    const double distance = (p - result.point).norm();
    result.distance = (p - result.point).dot(result.normal) < 0.0 ? -distance : distance;
    return result;
}

double smallest_clearance(const TriMesh& mesh, const SurfaceDistance& body) {
    double smallest = std::numeric_limits<double>::infinity();
    const auto probe = [&](const Vec3& p) {
        smallest = std::min(smallest, body.nearest(p).distance);
    };
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i) probe(mesh.vertices.row(i));
    for (const auto& [a, b] : undirected_edges(mesh.faces))
        probe(0.5 * (mesh.vertices.row(a) + mesh.vertices.row(b)));
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        probe((mesh.vertices.row(mesh.faces(f, 0)) + mesh.vertices.row(mesh.faces(f, 1)) +
               mesh.vertices.row(mesh.faces(f, 2))) /
              3.0);
    return smallest;
}

}  // namespace cloth
