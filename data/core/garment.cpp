#include "data/core/garment.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

static void validate_fabric(const std::string& name, const Fabric& fabric) {
    check_range(name + ": fabric.density", fabric.density, 1e-3, 1e3);
    check_range(name + ": fabric.mu", fabric.mu, 0.0, 1e6);
    check_range(name + ": fabric.lambda", fabric.lambda, 0.0, 1e6);
    check_range(name + ": fabric.bending", fabric.bending, 0.0, 1.0);
}

static std::vector<Hinge> find_hinges(const Faces& faces) {
    std::map<std::array<int, 2>, std::array<int, 3>> first;  // edge -> (a, b, opposite)
    std::vector<Hinge> hinges;
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int corner = 0; corner < 3; ++corner) {
            const int a = faces(f, corner);
            const int b = faces(f, (corner + 1) % 3);
            const int opposite = faces(f, (corner + 2) % 3);
            const std::array<int, 2> key = {std::min(a, b), std::max(a, b)};
            const auto [it, inserted] = first.try_emplace(key, std::array<int, 3>{a, b, opposite});
            if (!inserted)
                hinges.push_back({it->second[0], it->second[1], it->second[2], opposite});
        }
    return hinges;
}

double dihedral_angle(const Points& x, const Hinge& h) {
    const Vec3 x0 = x.row(h[0]), x1 = x.row(h[1]), x2 = x.row(h[2]), x3 = x.row(h[3]);
    const Vec3 n0 = (x1 - x0).cross(x2 - x0);
    const Vec3 n1 = (x0 - x1).cross(x3 - x1);
    const Vec3 e = (x1 - x0).normalized();
    return std::atan2(e.dot(n0.cross(n1)), n0.dot(n1));
}

Garment::Garment(std::string name, TriMesh rest, Fabric fabric, std::vector<int> pins,
                 bool rest_angles)
    : m_name(std::move(name)),
      m_rest(std::move(rest)),
      m_fabric(fabric),
      m_rest_angles_from_mesh(rest_angles),
      m_pins(std::move(pins)) {
    validate_mesh(m_name, m_rest);
    validate_fabric(m_name, m_fabric);
    std::sort(m_pins.begin(), m_pins.end());
    m_pins.erase(std::unique(m_pins.begin(), m_pins.end()), m_pins.end());
    m_is_pinned.assign(vertex_count(), 0);
    for (int pin : m_pins) {
        if (pin < 0 || pin >= vertex_count())
            throw ArgumentError(m_name + ": pin " + std::to_string(pin), "is not a vertex",
                                "pins are vertex numbers from 0 to |V| - 1");
        m_is_pinned[pin] = 1;
    }
    m_edges = undirected_edges(m_rest.faces);
    for (const auto& [a, b] : m_edges)
        m_mean_edge_length += (m_rest.vertices.row(a) - m_rest.vertices.row(b)).norm();
    m_mean_edge_length /= static_cast<double>(m_edges.size());
    m_hinges = find_hinges(m_rest.faces);
    m_hinge_rest_angles = VectorX::Zero(static_cast<Eigen::Index>(m_hinges.size()));
    if (rest_angles)
        for (size_t h = 0; h < m_hinges.size(); ++h)
            m_hinge_rest_angles[h] = dihedral_angle(m_rest.vertices, m_hinges[h]);
    m_face_areas = face_area_vectors(m_rest.vertices, m_rest.faces).rowwise().norm();
    m_masses = VectorX::Zero(vertex_count());
    for (Eigen::Index f = 0; f < face_count(); ++f)
        for (int corner = 0; corner < 3; ++corner)
            m_masses[m_rest.faces(f, corner)] += m_fabric.density * m_face_areas[f] / 3.0;
    for (Eigen::Index i = 0; i < vertex_count(); ++i)
        if (!(m_masses[i] > 0.0))
            throw ArgumentError(m_name, "vertex " + std::to_string(i) + " belongs to no face",
                                "remove unreferenced vertices");
}

VectorX Garment::inverse_masses() const {
    VectorX inverse = m_masses.cwiseInverse();
    for (const int pin : m_pins) inverse[pin] = 0.0;
    return inverse;
}

std::vector<char> Garment::is_held() const {
    std::vector<char> held = m_is_pinned;
    for (Eigen::Index i = 0; i < m_goal_limits.max_distance.size(); ++i)
        if (m_goal_limits.max_distance[i] == 0.0) held[static_cast<size_t>(i)] = 1;
    return held;
}

VectorX Garment::mobilities() const {
    VectorX mobilities = m_masses.cwiseInverse();
    const std::vector<char> held = is_held();
    for (size_t i = 0; i < held.size(); ++i)
        if (held[i]) mobilities[static_cast<Eigen::Index>(i)] = 0.0;
    return mobilities;
}

Garment Garment::with_fabric(const Fabric& fabric) const {
    return Garment(m_name, m_rest, fabric, m_pins, m_rest_angles_from_mesh)
        .with_goals(m_goal_limits);
}

Garment Garment::with_pins(std::vector<int> pins) const {
    return Garment(m_name, m_rest, m_fabric, std::move(pins), m_rest_angles_from_mesh)
        .with_goals(m_goal_limits);
}

Garment Garment::with_goals(GoalLimits limits) const {
    check(limits, vertex_count(), m_name);
    Garment garment = *this;
    garment.m_goal_limits = std::move(limits);
    garment.m_has_goals = !garment.m_goal_limits.empty();
    return garment;
}

}  // namespace cloth
