#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "collision/geometry/motion_tree.h"
#include "collision/proximity/proximity.h"
#include "collision/proximity/surface_samples.h"

namespace cloth {

class NeighbourPull;

/// A point of an obstacle's surface at both ends of a step.
struct CarriedPoint {
    int face = -1;                    ///< of a mesh
    Vec3 barycentric = Vec3::Zero();  ///< in that face, or the point in a primitive's frame
    Vec3 point0 = Vec3::Zero(), point1 = Vec3::Zero();    ///< at t and at t + dt (m)
    Vec3 normal0 = Vec3::Zero(), normal1 = Vec3::Zero();  ///< unit, outward
};

/// A point of a garment's surface that went through a solid.
struct Tunnelling {
    int point = -1;           ///< a vertex, or |V| + a sample (see SurfaceSamples)
    int obstacle = -1;        ///< index into Boundary::obstacles
    std::optional<int> limb;  ///< of that obstacle; none: it has no limbs
    double thickness = 0.0;   ///< from where it went in to where it came out, at t + dt (m)
    CarriedPoint in;          ///< where it went in
};

/// Continuous collision detection: what a garment went through between two frames, although it is
/// outside at both.
///
///     TunnellingDetector detector(garment);
///     for (const Tunnelling& solid : detector.find(boundary, x_before, x_after, threads)) { ... }
///
/// Vertices move on straight lines, obstacles evenly. A vertex went through a solid if it went in
/// and came out on sides that face away from each other, 5 mm apart or more: cloth
/// that slides around an arm, or over the edge of a box, cuts corners but goes through nothing. A
/// vertex that starts (or ends) inside, no deeper than 5 mm, went in (or came out) where it is
/// nearest to the surface; in a mesh, one that does both is not seen. One that starts deeper is not
/// reported, one that ends deeper is. Pinned vertices, which go where they are told, and limbs that
/// a vertex ignores are passed over; in at one limb and out at another is a fold of the body, no
/// solid. In a mesh without limbs it counts as one: there, the finer steps that follow keep cloth
/// from being torn between surfaces that close on it.
///
/// Meshes: a hierarchy of FCL's (ObstacleTrees, as in Proximity), told apart by relative motion,
/// and FCL's continuous test of point and triangle. Primitives: conservative advancement in their
/// own frame; that costs so little that face centres and edge midpoints are followed too. Through
/// meshes, only those that are still inside: add_samples().
class TunnellingDetector {
 public:
    /// @param trees  see Proximity
    explicit TunnellingDetector(const Garment& garment,
                                std::shared_ptr<ObstacleTrees> trees = nullptr);
    ~TunnellingDetector();

    /// Replaces found(), whose order depends on the arguments alone. Unusable obstacles (see
    /// check_obstacles) are passed over.
    /// @param x0, x1   the garment's vertices at t and t + dt (|V| x 3, m)
    /// @param threads  0: as many as OpenMP gives
    const std::vector<Tunnelling>& find(const Boundary& boundary, const Points& x0,
                                        const Points& x1, int threads);

    const std::vector<Tunnelling>& found() const { return m_found; }

    /// Holds what was found on the side that it came from: in `contacts`, the nearest points of |V|
    /// vertices, those of vertices that went through something become the points where they went
    /// in, at no distance; face centres and edge midpoints get contacts of their own, as over
    /// ridges. `x` (|V| x 3, m, at t + dt) is moved out to these planes; pins are not.
    void hold_where_they_went_in(SurfaceContacts& contacts, Points& x) const;

    /// Moves what was found back to where it went in, `clearance` (m) outside. Points that have no
    /// room there, because another surface is in the way, or that would still be through something,
    /// stay where they were; found() has these afterwards.
    /// @param boundary, x0, threads  as find() had them
    /// @param x  |V| x 3 (m), the x1 that find() had; changed
    /// @param pull  brings the neighbours of what is moved along; null: they stay
    /// @return   how deep the edge midpoints and face centres beside what moved are then (m), or 0
    double take_back(const Boundary& boundary, const Points& x0, double clearance, int threads,
                     Points& x, NeighbourPull* pull = nullptr);

    /// Where a deep sample went into the mesh that it is in, on a straight line from where its
    /// vertices were at t; none: it was inside before, did not move, or went in at another limb
    /// than the one that it is nearest to, which is a fold.
    /// @param samples  after find_deep() at t + dt
    /// @param x0       |V| x 3 (m)
    std::optional<CarriedPoint> way_in(const Boundary& boundary, const SurfaceSamples& samples,
                                       int sample, const Points& x0) const;

    /// Adds samples that are deeper in a mesh than `depth` (m), and whose way in is known, to
    /// found(): a finger goes through a face without meeting a vertex.
    /// @param x0, x1  as in find()
    void add_samples(const Boundary& boundary, const Points& x0, const Points& x1, double depth);

    /// Of the solids (obstacles, or limbs) that were gone through, how thick the thinnest is (m):
    /// as thick as the longest way through it; none: nothing was gone through.
    std::optional<double> thinnest() const;

 private:
    struct Crossing;

    void search(const Boundary& boundary, const Points& x0, const Points& x1,
                const std::vector<int>& vertices, int threads);
    void place_samples(const Points& x0, const Points& x1);
    void find_in_primitive(const Boundary& boundary, int obstacle, const Points& x0,
                           const Points& x1, const std::vector<int>& vertices);
    void find_in_mesh(const Boundary& boundary, int obstacle, const Points& x0, const Points& x1,
                      const std::vector<int>& vertices, int threads);
    static Crossing cross(const Obstacle& mesh, const MotionTree& tree, const Vec3& p0,
                          const Vec3& p1, LimbSet ignored, std::vector<int>& stack);
    void complete(const Boundary& boundary, int obstacle, const Points& x, StepEnd end);
    void report(const Crossing& crossing, const Boundary& boundary, int obstacle,
                const std::vector<std::uint8_t>* limbs);
    void lift_corners(const Tunnelling& through, double clearance, Points& x) const;
    std::vector<int> vertices_of_found() const;
    std::vector<int> inside(const Boundary& boundary, const std::vector<int>& vertices,
                            const Points& x);

    SurfaceSamples m_samples;
    std::vector<char> m_pinned;   ///< |V|
    std::vector<int> m_vertices;  ///< those that are not
    std::vector<Crossing> m_crossings;
    std::vector<std::vector<Crossing>> m_parts;
    std::vector<int> m_rows;
    Points m_samples0, m_samples1;           ///< |samples| x 3 (m): at t and at t + dt
    double m_longest_way = 0.0;              ///< of vertices, and so of samples (m)
    std::vector<char> m_moved;               ///< |V|: by take_back()
    bool m_owns_trees;                       ///< whether they are of this object alone
    std::shared_ptr<ObstacleTrees> m_trees;  ///< used where Boundary::trees is null
    Proximity m_proximity;
    SurfaceContacts m_contacts;  ///< |V|
    std::vector<Tunnelling> m_found;
};

}  // namespace cloth
