#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "data/files/painted_mesh.h"
#include "data/files/painted_places.h"

struct aiMesh;

namespace cloth {

/// Gathers what is painted on the vertices of a file while load_mesh() numbers them.
class VertexPaint {
 public:
    /// @throws ArgumentError if the colours are out of range
    explicit VertexPaint(const std::optional<GoalColours>& colours);

    /// To be called once, after assimp has read the file.
    void open(const std::string& path);
    /// @param numbers  of the mesh's vertices in the result, or -1 for those of no face
    void add(const aiMesh& mesh, const std::vector<int>& numbers);

    /// @param vertices  of the result
    GoalLimits limits(Eigen::Index vertices) const;
    bool has_unread_colours() const { return m_unread_colours; }

 private:
    bool add_attributes(const aiMesh& mesh, const std::vector<int>& numbers);
    void add_colours(const aiMesh& mesh, const std::vector<int>& numbers);
    void tighten(int number, const PaintedVertex& painted);

    std::string m_path;
    std::optional<GoalColours> m_colours;
    std::vector<PaintedPart> m_parts;
    std::vector<PaintedVertex> m_vertices;
    std::array<bool, 4> m_has{};
    bool m_unread_colours = false;
};

/// load_mesh() that lets `paint`, if it is not null, look at the vertices.
TriMesh load_mesh(const std::string& path, const std::string& mesh_name,
                  FacesWithoutArea without_area, VertexPaint* paint);

}  // namespace cloth
