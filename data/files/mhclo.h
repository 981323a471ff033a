#pragma once

#include <array>
#include <string>
#include <vector>

#include "data/core/mesh.h"

namespace cloth {

/// Where a vertex of MakeHuman's clothes is: at a weighted place between three vertices of the base
/// mesh, and an offset beside it.
struct MhcloRow {
    std::array<int, 3> vertices{};
    Vec3 weights = Vec3(1.0, 0.0, 0.0);
    Vec3 offset = Vec3::Zero();  ///< in the file's units; scaled with the body, axis by axis
};

/// MakeHuman's file of a piece of clothes (.mhclo, text): fits the mesh of an OBJ file beside it to
/// any shape of the base mesh.
///
///     const MhcloFile suit = load_mhclo("suit.mhclo");
///     const TriMesh worn = load_mhclo_mesh(suit, shapes.base_mesh(shape));
///
/// Of its lines these are read: `obj_file NAME`, `x_scale A B D` (y, z), and after `verts 0` a row
/// for each vertex of the OBJ file, `a b c wa wb wc dx dy dz`, or `a` alone: the vertex a itself.
/// Materials, tags and `delete_verts` are left out.
struct MhcloFile {
    struct Scale {
        int from = -1, to = -1;  ///< vertices of the base mesh; -1: none, the offsets stay
        double distance = 1.0;   ///< of them along the axis when the offsets were written
    };
    std::string path;
    std::string name;
    std::string obj_file;  ///< path, beside the file itself
    std::array<Scale, 3> scales;
    std::vector<MhcloRow> rows;

    /// Highest vertex of the base mesh that it names.
    int highest_vertex() const;

    /// Places of the vertices of the OBJ file (|rows| x 3), in the unit of the base mesh:
    ///     p = wa V[a] + wb V[b] + wc V[c] + (sx dx, sy dy, sz dz),  sx = |V[A].x - V[B].x| / D
    /// @param base  all vertices of the base mesh (19,158 x 3), helpers included
    /// @throws ArgumentError if the base mesh has too few vertices
    Points places(const Points& base) const;
};

/// @throws LoadError naming the line that is malformed, and if there is no OBJ file's name or no
///         row
MhcloFile load_mhclo(const std::string& path);

/// The mesh of the OBJ file with its vertices where they belong on a base mesh (m).
/// @throws LoadError if the OBJ file cannot be read, or has another number of vertices than rows
TriMesh load_mhclo_mesh(const MhcloFile& file, const Points& base);

}  // namespace cloth
