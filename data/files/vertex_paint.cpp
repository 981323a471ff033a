#include "data/files/vertex_paint.h"

#include <assimp/mesh.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/printable.h"

namespace cloth {

namespace {

constexpr double whole = 0.998;  // what counts as 1: half a step of 8 bits below

std::string place_of(const aiMesh& mesh, size_t vertex) {
    return "mesh " + printable(mesh.mName.C_Str()) + ", vertex " + std::to_string(vertex);
}

PaintedVertex painted_by(const GoalColours& colours, const std::array<double, 3>& rgb) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    PaintedVertex painted;
    painted.values[0] = rgb[0] >= whole ? infinity : rgb[0] * colours.max_distance;
    painted.values[1] = rgb[1] >= whole ? infinity : rgb[1] * colours.backstop;
    const double drive = rgb[2] >= whole ? 0.0 : 1.0 - rgb[2];
    painted.values[2] = drive * colours.drive_stiffness;
    painted.values[3] = drive * colours.drive_damping;
    return painted;
}

}  // namespace

void GoalColours::check() const {
    check_range("GoalColours.max_distance", max_distance, 0.001, 10.0);
    check_range("GoalColours.backstop", backstop, 0.001, 10.0);
    check_range("GoalColours.drive_stiffness", drive_stiffness, 0.0, 1e6);
    check_range("GoalColours.drive_damping", drive_damping, 0.0, 1e4);
}

VertexPaint::VertexPaint(const std::optional<GoalColours>& colours) : m_colours(colours) {
    if (m_colours) m_colours->check();
}

void VertexPaint::open(const std::string& path) {
    m_path = path;
    m_parts = read_painted_parts(path);
}

void VertexPaint::add(const aiMesh& mesh, const std::vector<int>& numbers) {
    if (add_attributes(mesh, numbers) || !mesh.HasVertexColors(0)) return;
    if (m_colours)
        add_colours(mesh, numbers);
    else
        m_unread_colours = true;
}

/// The parts of the file that the mesh is: assimp does not say which, so by its vertices.
bool VertexPaint::add_attributes(const aiMesh& mesh, const std::vector<int>& numbers) {
    bool found = false;
    for (const PaintedPart& part : m_parts) {
        std::vector<const PaintedVertex*> painted(numbers.size(), nullptr);
        bool is_this = part.rows.empty() || part.rows.size() == numbers.size();
        for (size_t i = 0; i < numbers.size() && is_this; ++i) {
            if (numbers[i] < 0) continue;
            if (!part.rows.empty()) {
                painted[i] = &part.rows[i];
                continue;
            }
            const aiVector3D& p = mesh.mVertices[i];
            const auto at = part.places.find({p.x + 0.0f, p.y + 0.0f, p.z + 0.0f});
            is_this = at != part.places.end();
            if (is_this) painted[i] = &at->second;
        }
        if (!is_this) continue;
        found = true;
        for (size_t k = 0; k < m_has.size(); ++k) m_has[k] = m_has[k] || part.has[k];
        for (size_t i = 0; i < numbers.size(); ++i)
            if (painted[i]) tighten(numbers[i], *painted[i]);
    }
    return found;
}

void VertexPaint::add_colours(const aiMesh& mesh, const std::vector<int>& numbers) {
    for (size_t i = 0; i < numbers.size(); ++i) {
        if (numbers[i] < 0) continue;
        const aiColor4D& colour = mesh.mColors[0][i];
        std::array<double, 3> rgb{static_cast<double>(colour.r), static_cast<double>(colour.g),
                                  static_cast<double>(colour.b)};
        for (double& channel : rgb) {
            constexpr double rounding = 1e-6;
            if (!(channel >= -rounding && channel <= 1.0 + rounding))
                throw LoadError(m_path, place_of(mesh, i),
                                "its colour is not within 0 to 1 in each channel",
                                "paint it again, or leave the colours out");
            channel = std::clamp(channel, 0.0, 1.0);
        }
        tighten(numbers[i], painted_by(*m_colours, rgb));
    }
    m_has.fill(true);
}

void VertexPaint::tighten(int number, const PaintedVertex& painted) {
    const auto at = static_cast<size_t>(number);
    if (m_vertices.size() <= at) m_vertices.resize(at + 1);
    m_vertices[at].tighten(painted);
}

GoalLimits VertexPaint::limits(Eigen::Index vertices) const {
    GoalLimits limits;
    VectorX* const arrays[] = {&limits.max_distance, &limits.backstop, &limits.drive_stiffness,
                               &limits.drive_damping};
    for (size_t k = 0; k < m_has.size(); ++k) {
        if (!m_has[k]) continue;
        arrays[k]->setConstant(vertices, PaintedVertex().values[k]);
        for (size_t i = 0; i < m_vertices.size(); ++i)
            (*arrays[k])[static_cast<Eigen::Index>(i)] = m_vertices[i].values[k];
    }
    return limits;
}

}  // namespace cloth
