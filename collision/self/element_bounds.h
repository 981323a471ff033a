#pragma once

#include <cmath>
#include <vector>

#include "collision/self/self_elements.h"

namespace cloth {

/// Spheres around the elements of a garment and around their motions: tells most pairs of elements
/// that cannot be a SelfPair apart by a few multiplications.
class ElementBounds {
 public:
    /// @param x, motion  |V| x 3 (m)
    void update(const SelfElements& elements, const Points& x, const Points& motion);

    /// How far (m) points of faces f and g may approach each other in the step.
    double approach(int f, int g) const {
        const Disc &a = m_faces[static_cast<size_t>(f)], &b = m_faces[static_cast<size_t>(g)];
        return (a.motion - b.motion).norm() + a.motion_radius + b.motion_radius;
    }

    /// False only if a vertex and a face, or two edges, stay further apart than `far` (m) or do not
    /// face each other.
    bool may_be_near(const ElementPair& pair, const Points& x, double far) const {
        const auto [first, second] = pair.element;
        return pair.edges ? may_edges_be_near(first, second, far)
                          : may_vertex_be_near(x.row(first), second, far);
    }

 private:
    struct Disc {
        Vec3 centre, normal, motion;  ///< of a face; its unit normal; the mean motion (m)
        double radius, motion_radius;
    };
    struct Rod {
        Vec3 middle, half;  ///< of an edge; from there to an end
        double length;      ///< of the half
    };

    /// From outside the face, above its plane by less than it is beside the face, nothing faces it.
    bool may_vertex_be_near(const Vec3& x, int face, double far) const {
        const Disc& disc = m_faces[static_cast<size_t>(face)];
        const Vec3 to = x - disc.centre;
        const double squared = to.squaredNorm(), limit = disc.radius + far;
        if (squared > limit * limit) return false;
        const double height = std::abs(to.dot(disc.normal)), beside = disc.radius + height;
        return !(squared - height * height > beside * beside);
    }

    /// Edges face each other where their lines are nearest between the ends of both.
    bool may_edges_be_near(int a, int b, double far) const {
        const Rod &first = m_edges[static_cast<size_t>(a)],
                  &second = m_edges[static_cast<size_t>(b)];
        const Vec3 to = second.middle - first.middle;
        const double limit = first.length + second.length + far;
        if (to.squaredNorm() > limit * limit) return false;
        const double uu = first.length * first.length, vv = second.length * second.length;
        const double uv = first.half.dot(second.half);
        const double ut = first.half.dot(to), vt = second.half.dot(to);
        const double scale = (1.0 + 1e-9) * (uu * vv - uv * uv);
        return std::abs(ut * vv - uv * vt) <= scale && std::abs(uv * ut - uu * vt) <= scale;
    }

    std::vector<Disc> m_faces;
    std::vector<Rod> m_edges;
};

}  // namespace cloth
