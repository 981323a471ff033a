#include "gnn/physics/xpbd/distance_constraints.h"

#include <algorithm>
#include <cmath>

namespace cloth {
namespace {

using Row = Eigen::Map<Eigen::Vector4d>;

constexpr int run_length = 32;      // constraints: their work space stays in the first-level cache
constexpr double shortest = 1e-12;  // m; a spring of no length has no direction and does nothing
constexpr double softest = 1e-12;   // N/m; what pulls less does nothing

/// Springs that pull, by colour: each gets the first colour that neither of its vertices has.
std::vector<std::vector<Spring>> coloured(const std::vector<Spring>& springs, size_t vertices) {
    std::vector<std::vector<Spring>> colours;
    std::vector<std::vector<char>> has_colour;  // colours x |V|
    for (const Spring& spring : springs) {
        if (!(spring.stiffness > softest)) continue;
        const size_t a = static_cast<size_t>(spring.a), b = static_cast<size_t>(spring.b);
        size_t colour = 0;
        while (colour < colours.size() && (has_colour[colour][a] || has_colour[colour][b]))
            ++colour;
        if (colour == colours.size()) {
            colours.emplace_back();
            has_colour.emplace_back(vertices, char(0));
        }
        colours[colour].push_back(spring);
        has_colour[colour][a] = has_colour[colour][b] = 1;
    }
    return colours;
}

}  // namespace

DistanceConstraints::DistanceConstraints(const std::vector<Spring>& springs,
                                         const VectorX& inverse_masses, double relaxation)
    : m_relaxation(relaxation) {
    m_colours.push_back(0);
    for (const auto& colour : coloured(springs, static_cast<size_t>(inverse_masses.size()))) {
        for (const Spring& spring : colour) {
            m_vertices.insert(m_vertices.end(), {spring.a, spring.b});
            m_rest.push_back(spring.rest_length);
            m_max_extension.push_back(spring.max_extension);
            m_stiffness.push_back(spring.stiffness);
            m_mass_a.push_back(inverse_masses[spring.a]);
            m_mass_b.push_back(inverse_masses[spring.b]);
        }
        m_colours.push_back(static_cast<int>(m_rest.size()));
    }
    m_alpha.resize(size()), m_share.resize(size()), m_multiplier.resize(size());
}

void DistanceConstraints::set_time_step(double h) {
    for (size_t e = 0; e < size(); ++e) {
        m_alpha[e] = 1.0 / (m_stiffness[e] * h * h);
        const double plain = 1.0 / (m_mass_a[e] + m_mass_b[e] + m_alpha[e]);
        m_share[e] = std::min(m_relaxation * plain, 1.0 / m_alpha[e]);
    }
}

/// Three loops, because only the middle one, roots and divisions, gains by crossing constraints.
void DistanceConstraints::relax_run(double* x, int begin, int count, bool first) {
    double difference[4 * run_length], move[run_length];
    const int* vertices = &m_vertices[2 * begin];
    for (int e = 0; e < count; ++e) {
        const Eigen::Vector4d d = Row(x + 4 * vertices[2 * e + 1]) - Row(x + 4 * vertices[2 * e]);
        Row(difference + 4 * e) = d;
        move[e] = d.squaredNorm();
    }
    for (int e = 0, c = begin; e < count; ++e, ++c) {
        const double length = std::max(std::sqrt(move[e]), shortest);
        const double extension = std::min(length - m_rest[c], m_max_extension[c]);
        const double old = first ? 0.0 : m_multiplier[c];
        const double change = (extension - m_alpha[c] * old) * m_share[c];
        m_multiplier[c] = old + change;
        move[e] = change / length;
    }
    for (int e = 0, c = begin; e < count; ++e, ++c) {
        const Row d(difference + 4 * e);
        Row(x + 4 * vertices[2 * e]) += (m_mass_a[c] * move[e]) * d;
        Row(x + 4 * vertices[2 * e + 1]) -= (m_mass_b[c] * move[e]) * d;
    }
}

void DistanceConstraints::relax(PaddedPoints& x, bool first) {
    for (size_t c = 0; c + 1 < m_colours.size(); ++c)
        for (int e = m_colours[c]; e < m_colours[c + 1]; e += run_length)
            relax_run(x.data(), e, std::min(run_length, m_colours[c + 1] - e), first);
}

}  // namespace cloth
