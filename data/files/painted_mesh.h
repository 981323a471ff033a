#pragma once

#include <optional>
#include <string>

#include "data/core/mesh.h"
#include "data/core/skin_goals.h"
#include "data/core/weld.h"
#include "data/files/mesh_io.h"

namespace cloth {

/// How colours of vertices, each channel from 0 to 1 as the file stores it, are read as limits of
/// goals. White is free cloth; what is darker is held:
///
/// - red: `max_distance` times its value; 1 is free, 0 is held at the goal;
/// - green: `backstop` times its value; 1 has none;
/// - blue: the drive is as strong as 1 minus its value; 1 has none.
///
/// From 0.998 on, which is half a step of 8 bits below 1, a value counts as 1. Alpha does nothing.
struct GoalColours {
    double max_distance = 0.2;       ///< (m), 0.001 to 10
    double backstop = 0.1;           ///< (m), 0.001 to 10
    double drive_stiffness = 400.0;  ///< (1/s^2), 0 to 1e6
    double drive_damping = 20.0;     ///< (1/s), 0 to 1e4

    /// @throws ArgumentError naming the field that is out of range
    void check() const;
};

/// A mesh of a file, and what is painted on its vertices.
struct PaintedMesh {
    TriMesh mesh;
    GoalLimits limits;            ///< of its vertices; an array is empty where nothing says so
    bool unread_colours = false;  ///< it has colours, and nobody asked for them
};

/// Reads a mesh as load_mesh() does, and the limits of its skinned goals:
///
///     const PaintedMesh cape = load_painted_mesh("cape.glb");
///     const Garment garment = Garment("cape", cape.mesh, fabric).with_goals(cape.limits);
///
/// - glTF: the attributes `_MAX_DISTANCE`, `_BACKSTOP`, `_DRIVE_STIFFNESS` and `_DRIVE_DAMPING`,
///   one number per vertex, 32-bit float or normalised 8 or 16 bits;
/// - PLY: properties of these names without the underscore, of any type;
/// - glTF, PLY, OBJ, COLLADA: colours of the vertices, only if asked for by `colours`, and only of
///   meshes that have none of the attributes.
///
/// Numbers are in the units of GoalLimits, whatever the unit of the positions is. Capital letters
/// and small ones are the same. Where a seam has split a vertex, and it has several values, the
/// tightest counts: the smallest distance and backstop, the strongest drive.
///
/// @throws LoadError as load_mesh(), and naming the attribute and the vertex: of another number of
///         values than there are vertices, of another type, or with a value that is not a number,
///         or out of the range of GoalLimits. ArgumentError if `colours` is out of range
PaintedMesh load_painted_mesh(const std::string& path, const std::string& mesh_name = "",
                              FacesWithoutArea without_area = FacesWithoutArea::refuse,
                              const std::optional<GoalColours>& colours = {});

/// Limits of the vertices that weld_mesh() left; where several became one, the tightest.
/// @param limits  of the mesh that was welded
/// @throws ArgumentError if they are of another mesh
GoalLimits welded_limits(const GoalLimits& limits, const WeldedMesh& welded);

/// Writes mesh and limits as a binary PLY that load_painted_mesh() reads; positions lose what
/// single precision does not hold. The file appears whole or not at all.
/// @throws LoadError if the file cannot be written, ArgumentError if the limits are of another mesh
void save_painted_ply(const std::string& path, const TriMesh& mesh, const GoalLimits& limits);

}  // namespace cloth
