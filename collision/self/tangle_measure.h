#pragma once

#include <array>
#include <vector>

#include "collision/self/self_tangles.h"
#include "collision/self/tangled_regions.h"

namespace cloth {

/// How badly a garment is tangled, as a length (m) that is 0 only without tangles: P = L + A / r
/// with r = 1 cm.
///
/// L is the length of the lines along which surfaces pass through each other (Volino and
/// Magnenat-Thalmann 2006, "Resolving surface collisions through intersection contour
/// minimization"): it draws in folds and corners, whatever side is right, and slits, which part
/// nothing. A is the area, at rest, of what is on the wrong side (TangledRegions): it draws back
/// what has gone through in full, on which L does not depend. Each face is counted as if it was cut
/// straight between its edges. P is continuous where vertices and edges come out of faces; it may
/// jump where faces lie in one plane, or another side becomes the smaller one.
///
///     TangleMeasure measure(garment);
///     if (measure.find(x, threads) > 0.0) measure.gradient(x, gradient);
class TangleMeasure {
 public:
    explicit TangleMeasure(const Garment& garment);

    /// Finds the tangles at x (|V| x 3, m) and returns P (m). @param threads  0: as OpenMP gives
    /// @param known       see TangledRegions::find()
    /// @param overlapped  see SelfTangles::find()
    double find(const Points& x, int threads, const std::vector<char>* known = nullptr,
                const std::vector<char>& overlapped = {});

    /// Of the last find(). @param x  that it was given
    double length() const { return m_length; }  ///< L (m)
    double area() const { return m_area; }      ///< A (m^2)
    const std::vector<Tangle>& tangles() const { return m_tangles.found(); }
    const TangledRegions& regions() const { return m_regions; }

    /// Replaces `gradient` by dP/dx (|V| x 3) of the last find(). Its rows add up to 0.
    /// @param steepest  bounds 1 / (n e) of an edge e that passes through a face of normal n:
    /// nearly
    ///                  in the face, it slides far along it for a small motion. The exact gradient
    ///                  has no bound; forces of a bounded one balance too
    void gradient(const Points& x, Points& gradient, double steepest = 1e300);

 private:
    /// Of the line in which two faces meet: from a tangle to another, or to a vertex of both.
    struct Segment {
        int tangle, other;  ///< -1: to the vertex
        int vertex;
    };
    struct OnFace {  ///< a tangle's edge passes through one of two faces that meet
        std::array<int, 2> faces;
        int tangle;
    };

    void find_segments();
    void measure_length(const Points& x);
    void measure_area();
    double wrong_share(int edge, double& sign) const;
    int common_vertex(int f, int g) const;
    void add_point(const Tangle& tangle, const Vec3& pull, double slide, const Points& x,
                   double steepest, Points& gradient) const;

    SelfTangles m_tangles;
    TangledRegions m_regions;
    Faces m_faces;
    std::vector<std::array<int, 2>> m_edges;
    std::vector<std::array<int, 2>> m_edge_faces;  ///< |E|, -1: a border
    std::vector<std::array<int, 3>> m_face_edges;  ///< |F|: from corner k to the next
    VectorX m_face_areas;                          ///< |F| (m^2), at rest
    std::vector<OnFace> m_on_faces;
    std::vector<Segment> m_segments;
    std::vector<double> m_along;  ///< |tangles|: 0 at the edge's first end, 1 at its second
    std::vector<int> m_cut;       ///< |E|: the tangle that parts its ends, -1: none
    std::vector<double> m_slide;  ///< |tangles|: dA / d along (m^2)
    std::vector<Vec3> m_pull;     ///< |tangles|: dL / d point
    double m_length = 0.0, m_area = 0.0;
};

}  // namespace cloth
