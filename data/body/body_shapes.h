#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "data/core/types.h"

namespace cloth {

/// A young adult in eleven numbers. The defaults are the default body: average in everything.
struct BodyShape {
    double female = 0.5;       ///< 0 male to 1 female
    double height = 0.5;       ///< 0 to 1; 0.375 to 0.625 spans 1.5 to 1.95 m
    double weight = 0.5;       ///< 0 thin to 1 fat
    double muscle = 0.5;       ///< 0 weak to 1 strong
    double african = 1.0 / 3;  ///< 0 to 1; the three descents sum to 1,
    double asian = 1.0 / 3;    ///< 0 to 1; caucasian is what is left
    double bust = 0.0;         ///< girths and breadths: -1 small, 0 average, 1 large
    double waist = 0.0;
    double hips = 0.0;
    double shoulders = 0.0;
    double limbs = 0.0;  ///< girth of thighs, calves and upper arms
};

/// A plausible person: the same for the same seed, everywhere.
BodyShape sample_body_shape(uint64_t seed);

/// One MakeHuman shape target: how far (file units) it moves which vertices.
struct ShapeTarget {
    std::vector<int> vertices;
    Points offsets;  ///< |vertices| x 3
};

/// Reads a .target file: rows 'index dx dy dz', comments start with '#'.
/// @throws LoadError naming the line of a malformed row or an index not below `vertex_count`
ShapeTarget load_shape_target(const std::string& path, int vertex_count);

/// MakeHuman's base mesh and shape targets (CC0): bodies of any BodyShape, all with the topology of
/// the default body, so Body::with_rest() takes them.
class BodyShapes {
 public:
    /// @param folder  holds base.obj and targets/
    /// @throws LoadError
    explicit BodyShapes(const std::string& folder);

    /// From the shared data folder; nothing where that is not present.
    static std::optional<BodyShapes> load_shared();

    /// Skin vertices (13,380 x 3, m): standing on y = 0, facing +z, in the order of the default
    /// body.
    Points skin(const BodyShape& shape) const;

    /// All vertices of the base mesh (m), helpers included, in the same frame as skin().
    Points base_mesh(const BodyShape& shape) const;

 private:
    struct NamedTarget {
        std::string name;
        ShapeTarget target;
    };
    void add(Points& points, const std::string& name, double weight) const;
    void add_descent(Points& points, const BodyShape& shape) const;
    void add_build(Points& points, const BodyShape& shape) const;
    void add_slider(Points& points, const std::string& name, double value) const;

    Points m_base;  ///< decimetres
    std::vector<NamedTarget> m_targets;
};

}  // namespace cloth
