#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "collision/self/self_elements.h"

namespace cloth {

/// Spheres around the elements of a garment and around their motions: tells most pairs of elements
/// that are far from each other, or cannot be a SelfPair, apart by a few multiplications. In single
/// precision, with room for what that rounds off.
class ElementBounds {
 public:
    /// @param x, motion  |V| x 3 (m)
    void update(const SelfElements& elements, const Points& x, const Points& motion);

    /// How far (m) points of faces f and g may approach each other in the step.
    float approach(int f, int g) const {
        const Motion &a = m_motions[static_cast<size_t>(f)], &b = m_motions[static_cast<size_t>(g)];
        return std::sqrt((a.mean - b.mean).matrix().squaredNorm()) + a.radius + b.radius;
    }

    /// False only if a vertex and a face, or two edges, stay further apart than `far` (m) or do not
    /// face each other.
    bool may_face(const ElementPair& pair, float far) const {
        const auto [first, second] = pair.element;
        return pair.edges ? may_edges_face(first, second, far)
                          : may_vertex_face(first, second, far);
    }

    /// False only if a vertex and a face, or two edges, are further apart than `far` (m).
    bool may_be_near(const ElementPair& pair, float far) const {
        const auto [first, second] = pair.element;
        return pair.edges ? may_edges_be_near(first, second, far)
                          : may_vertex_be_near(first, second, far);
    }

 private:
    using Lanes = Eigen::Array4f;  ///< x, y, z and zero
    struct Motion {
        Lanes mean;  ///< of a face (m)
        float radius;
    };
    struct Disc {
        Lanes centre, normal;  ///< of a face; unit
        float radius;
    };
    struct Rod {
        Lanes middle, half;  ///< of an edge; from there to an end
        float length;        ///< of the half
    };
    static constexpr float relative = 1e-5f;  ///< what single precision leaves of a product of few

    static float dot(const Lanes& a, const Lanes& b) { return (a * b).sum(); }

    bool may_vertex_be_near(int vertex, int face, float far) const {
        const Disc& disc = m_discs[static_cast<size_t>(face)];
        const Lanes to = m_points[static_cast<size_t>(vertex)] - disc.centre;
        const float limit = disc.radius + far + m_rounding;
        return dot(to, to) <= limit * limit;
    }

    /// From outside the face, above its plane by less than it is beside the face, nothing faces it.
    bool may_vertex_face(int vertex, int face, float far) const {
        const Disc& disc = m_discs[static_cast<size_t>(face)];
        const Lanes to = m_points[static_cast<size_t>(vertex)] - disc.centre;
        const float squared = dot(to, to), limit = disc.radius + far + m_rounding;
        const float height = dot(to, disc.normal);
        const float beside = (1.0f + relative) * (disc.radius + std::abs(height)) + m_rounding;
        return (squared <= limit * limit) & (squared - height * height <= beside * beside);
    }

    /// What the edges extend along the line between their middles is less than these are apart.
    bool may_edges_be_near(int a, int b, float far) const {
        const Rod &first = m_rods[static_cast<size_t>(a)], &second = m_rods[static_cast<size_t>(b)];
        const Lanes to = second.middle - first.middle;
        const float squared = dot(to, to), limit = far + m_rounding;
        const float along = std::abs(dot(first.half, to)) + std::abs(dot(second.half, to));
        const float gap = (1.0f - relative) * squared - along;
        return (gap <= 0.0f) | (gap * gap <= squared * limit * limit);
    }

    /// Edges face each other where their lines are nearest between the ends of both.
    bool may_edges_face(int a, int b, float far) const {
        const Rod &first = m_rods[static_cast<size_t>(a)], &second = m_rods[static_cast<size_t>(b)];
        const Lanes to = second.middle - first.middle;
        const float limit = first.length + second.length + far + m_rounding;
        const float u = first.length, v = second.length, uv = dot(first.half, second.half);
        const float ut = dot(first.half, to), vt = dot(second.half, to);
        const float room = relative * limit + m_rounding;  // of `to`
        const float scale = (1.0f + relative) * u * u * v * v - uv * uv;
        const bool near = dot(to, to) <= limit * limit;
        const bool beside_first = std::abs(ut * v * v - uv * vt) <= scale + u * v * v * room;
        const bool beside_second = std::abs(uv * ut - u * u * vt) <= scale + u * u * v * room;
        return near & beside_first & beside_second;  // no branch: none is likely
    }

    std::vector<Lanes> m_points;  ///< |V|: from the first vertex (m)
    std::vector<Motion> m_motions;
    std::vector<Disc> m_discs;
    std::vector<Rod> m_rods;
    float m_rounding = 0.0f;  ///< of a difference of coordinates (m)
};

}  // namespace cloth
