#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "data/core/boundary.h"
#include "data/core/types.h"

namespace cloth {

/// The face of a mesh that is closest to a query point.
struct FaceHit {
    int face = -1;                    ///< -1: none within the radius
    Vec3 barycentric = Vec3::Zero();  ///< exactly zero for corners that do not span the feature
    double squared = 0.0;             ///< squared distance (m^2)
};

/// The face of a mesh that a ray meets first.
struct RayHit {
    int face = 0;
    double distance = 0.0;  ///< along the ray (m)
};

/// Closest-face queries against a mesh whose vertices move.
///
/// FCL builds the hierarchy; its binary nodes are merged into nodes of eight children whose boxes,
/// in single precision relative to the mesh's centre, are tested together. The boxes are widened
/// by more than the rounding, so the answer is the exact minimum over all faces, and equal
/// distances go to the lowest face: neither the hint nor the order of the visit can change it.
class ClosestFaceTree {
 public:
    static constexpr int width = 8;

    /// A node that is still to be visited, and its squared distance. Each thread brings a stack.
    struct Entry {
        std::int32_t child;
        float squared;
    };
    using Stack = std::vector<Entry>;

    /// `faces` must outlive the tree and be in range of `vertices`.
    /// @param radius  the largest radius of later queries (m)
    /// @param limbs   |F|: limb of each face, 0 to 31; null: all are limb 0
    ClosestFaceTree(const Points& vertices, const Faces& faces, double radius,
                    const std::vector<std::uint8_t>* limbs = nullptr);

    /// Moves the mesh (same faces). Cheap if `vertices` are those of the last call.
    void refit(const Points& vertices);

    /// Closest face within `radius` of q. Faces without area or with coordinates that are not
    /// finite are no candidates (their edges belong to their neighbours too).
    /// @param hint   a face that is probably close, or -1; it saves time
    /// @param stack  scratch memory
    /// @param ignored  limbs whose faces are no candidates
    FaceHit closest(const Vec3& q, double radius, int hint, Stack& stack,
                    LimbSet ignored = 0) const;

    /// One of several points that are asked for together.
    struct Query {
        Vec3 x;               ///< (m)
        double radius = 0.0;  ///< (m)
        int hint = -1;        ///< see closest()
        LimbSet ignored = 0;  ///< see closest()
    };
    static constexpr int packet = 8;

    /// The same for 1 to `packet` points, which is faster where they are near each other.
    void closest(const Query* queries, int count, Stack& stack, FaceHit* hits) const;

    /// First face that the ray from `q` along the unit vector `direction` meets within `length`.
    /// Where it meets an edge, either face or (rarely, by rounding) none may be reported.
    /// @param ignored   limbs whose faces the ray passes through
    std::optional<RayHit> first_hit(const Vec3& q, const Vec3& direction, double length,
                                    Stack& stack, LimbSet ignored = 0) const;

    /// The set that holds a face's limb.
    LimbSet limb(int face) const {
        return m_limbs.empty() ? 1u : LimbSet(1) << m_limbs[size_t(face)];
    }
    const Points& vertices() const { return m_vertices; }
    const Faces& faces() const { return *m_faces; }

 private:
    using Eight = Eigen::Array<float, width, 1>;
    using Vec4f = Eigen::Array4f;
    struct alignas(32) Node {
        Eight low[3], high[3];      ///< boxes of the children; empty boxes are +inf to -inf
        std::int32_t child[width];  ///< a node, or ~face
        LimbSet limbs[width];       ///< of the faces below
    };

    struct Packet;

    void build_nodes();
    void mark_limbs();
    void localize();
    void fit_nodes();
    void fit_below_middle();
    void fit_from_below(int first, int end);
    void fit_slots(Node& node) const;
    void fit_leaf(Node& node, int slot, int face) const;
    /// A bound for single-precision squared distances that keeps everything up to `squared`.
    static float widened(double squared) {
        return static_cast<float>(squared) * 1.000002f + std::numeric_limits<float>::min();
    }
    static void nearest_last(Entry* first, Entry* end);
    static Entry* push_children(const Node& node, const Eigen::Vector3f& q, float bound,
                                LimbSet ignored, Entry* end);
    double ray_distance(const Vec3& q, const Vec3& direction, int face) const;
    void try_face(const Vec3& q, int face, FaceHit& best) const;

    const Faces* m_faces;
    std::vector<std::uint8_t> m_limbs;
    double m_radius;
    Points m_vertices;
    Vec3 m_origin = Vec3::Zero();
    float m_padding = 0.0f;
    std::vector<Vec4f, Eigen::aligned_allocator<Vec4f>> m_local;  ///< |V|: relative to the origin
    std::vector<Node> m_nodes;                                    ///< parents before their children
    std::array<size_t, 2> m_middle = {};  ///< nodes of one level: [0] to [1]
    size_t m_stack_size = 0;              ///< enough for any query
};

}  // namespace cloth
