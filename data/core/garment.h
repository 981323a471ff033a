#pragma once

#include <array>
#include <string>
#include <vector>

#include "data/core/fabric.h"
#include "data/core/mesh.h"
#include "data/core/skin_goals.h"

namespace cloth {

/// Two faces that share the edge v[0]-v[1]; v[2] and v[3] are the corners opposite to it.
///
///        v2
///       /  \        face (v0, v1, v2) and face (v1, v0, v3), both counter-clockwise
///     v0 -- v1
///       \  /
///        v3
using Hinge = std::array<int, 4>;

/// Everything about a piece of cloth that never changes: rest mesh, topology, masses, pins, fabric,
/// limits of skinned goals.
/// Built once and shared by const reference; what changes lives in ClothState.
class Garment {
 public:
    /// @param rest_angles  true: the rest mesh's own dihedral angles are the rest angles; false:
    /// flat
    /// @throws ArgumentError if the mesh is unusable, a pin is out of range or a fabric constant is
    ///         out of its range, see Fabric
    Garment(std::string name, TriMesh rest, Fabric fabric, std::vector<int> pins = {},
            bool rest_angles = false);

    const std::string& name() const { return m_name; }
    const TriMesh& rest() const { return m_rest; }
    const Fabric& fabric() const { return m_fabric; }
    const std::vector<int>& pins() const { return m_pins; }             ///< sorted, unique
    const std::vector<char>& is_pinned() const { return m_is_pinned; }  ///< |V|
    const std::vector<std::array<int, 2>>& edges() const { return m_edges; }
    const std::vector<Hinge>& hinges() const { return m_hinges; }
    const VectorX& hinge_rest_angles() const { return m_hinge_rest_angles; }  ///< |hinges| (rad)
    bool rest_angles_from_mesh() const { return m_rest_angles_from_mesh; }    ///< else flat
    const VectorX& face_areas() const { return m_face_areas; }                ///< |F| (m^2)
    const VectorX& masses() const { return m_masses; }                        ///< |V| (kg)
    VectorX inverse_masses() const;     ///< |V| (1/kg), 0 for pinned vertices
    std::vector<char> is_held() const;  ///< |V|: 1 if pinned, or never away from its goal
    VectorX mobilities() const;         ///< |V|: inverse_masses(), 0 for held vertices too
    const GoalLimits& goal_limits() const { return m_goal_limits; }  ///< empty: none
    bool has_goals() const { return m_has_goals; }  ///< whether any of them limits anything
    Eigen::Index vertex_count() const { return m_rest.vertices.rows(); }
    Eigen::Index face_count() const { return m_rest.faces.rows(); }
    double mean_edge_length() const { return m_mean_edge_length; }  ///< at rest (m)

    /// The same garment of another fabric.
    Garment with_fabric(const Fabric& fabric) const;
    /// The same garment with other pinned vertices.
    Garment with_pins(std::vector<int> pins) const;
    /// The same garment with skinned goals.
    /// @throws ArgumentError if an array has a wrong size or a value is out of range
    Garment with_goals(GoalLimits limits) const;

 private:
    std::string m_name;
    TriMesh m_rest;
    Fabric m_fabric;
    bool m_rest_angles_from_mesh;
    std::vector<int> m_pins;
    std::vector<char> m_is_pinned;
    std::vector<std::array<int, 2>> m_edges;
    std::vector<Hinge> m_hinges;
    VectorX m_hinge_rest_angles;
    VectorX m_face_areas;
    VectorX m_masses;
    double m_mean_edge_length = 0.0;
    GoalLimits m_goal_limits;
    bool m_has_goals = false;
};

/// Signed dihedral angle of a hinge (rad): 0 when flat, positive when the faces fold so that their
/// normals part. Grinspun et al. 2003, section 3: theta = atan2(e . (n0 x n1), n0 . n1).
double dihedral_angle(const Points& x, const Hinge& hinge);

}  // namespace cloth
