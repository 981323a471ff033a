#include "collision/proximity/ridge_contacts.h"

#include <algorithm>

#include "collision/geometry/select_rows.h"
#include "collision/proximity/direction.h"
#include "collision/response/resolve.h"

namespace cloth {
namespace {

// Normals that part by less than 25 degrees: over edges of 2 cm the surface rises by 1 mm between
// the vertices, which the contact distance covers.
constexpr double smooth = 0.9;
// Skins that face each other are two bodies, or two limbs, and the cloth is pinched between them.
constexpr double opposite = -0.5;
constexpr double reach = 0.03;  // m: samples further from the surface get no contact

constexpr int enough_edges = 4000, enough_samples = 10000;  // to be worth waking threads for

bool in_reach(const SurfaceContacts& contacts, int vertex) {
    return contacts.has(vertex) && contacts.distance[vertex] < 2.0 * reach;
}

}  // namespace

RidgeFinder::RidgeFinder(const Garment& garment)
    : m_faces(garment.rest().faces), m_in_reach(static_cast<size_t>(garment.vertex_count())) {
    find_edges();
    m_bent.resize(m_edges.size());
    add_faces(garment.is_pinned());
    add_edges(garment.is_pinned());
    m_x.setZero(static_cast<Eigen::Index>(m_samples.size()), 3);
    m_rows.reserve(m_samples.size());
    m_ignored.resize(m_samples.size());
    Proximity().query(m_x, Boundary(), m_near);  // gives the rows their size
}

void RidgeFinder::find_edges() {
    const auto edge = [&](Eigen::Index face, int corner) -> std::array<int, 2> {
        const auto [low, high] =
            std::minmax(m_faces(face, corner), m_faces(face, (corner + 1) % 3));
        return {low, high};
    };
    for (Eigen::Index face = 0; face < m_faces.rows(); ++face)
        for (int corner = 0; corner < 3; ++corner) m_edges.push_back(edge(face, corner));
    std::sort(m_edges.begin(), m_edges.end());
    m_edges.erase(std::unique(m_edges.begin(), m_edges.end()), m_edges.end());
    for (Eigen::Index face = 0; face < m_faces.rows(); ++face) {
        std::array<int, 3>& of = m_face_edges.emplace_back();
        for (int corner = 0; corner < 3; ++corner)
            of[static_cast<size_t>(corner)] = static_cast<int>(
                std::lower_bound(m_edges.begin(), m_edges.end(), edge(face, corner)) -
                m_edges.begin());
    }
}

void RidgeFinder::add_faces(const std::vector<char>& pinned) {
    const auto is_free = [&](int face, int corner) {
        return pinned[static_cast<size_t>(m_faces(face, corner))] == 0;
    };
    for (int face = 0; face < static_cast<int>(m_faces.rows()); ++face)
        if (is_free(face, 0) || is_free(face, 1) || is_free(face, 2))
            m_samples.push_back(
                {face, {1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0}, m_face_edges[static_cast<size_t>(face)]});
}

/// Each edge once, as part of the first of its faces.
void RidgeFinder::add_edges(const std::vector<char>& pinned) {
    std::vector<Sample> midpoints(m_edges.size(), {-1, {0.0, 0.0, 0.0}, {}});
    for (int face = 0; face < static_cast<int>(m_faces.rows()); ++face)
        for (size_t corner = 0; corner < 3; ++corner) {
            const int edge = m_face_edges[static_cast<size_t>(face)][corner];
            Sample& midpoint = midpoints[static_cast<size_t>(edge)];
            if (midpoint.face >= 0) continue;
            midpoint.face = face;
            midpoint.weight[corner] = midpoint.weight[(corner + 1) % 3] = 0.5;
            midpoint.edge.fill(edge);
        }
    for (size_t edge = 0; edge < m_edges.size(); ++edge) {
        const auto& [a, b] = m_edges[edge];
        if (!pinned[static_cast<size_t>(a)] || !pinned[static_cast<size_t>(b)])
            m_samples.push_back(midpoints[edge]);
    }
}

void RidgeFinder::find(Proximity& proximity, const Boundary& boundary, const Points& x,
                       SurfaceContacts& contacts, StepEnd chosen_at) {
    contacts.ridges.clear();
    find_bent_edges(contacts, chosen_at);
    select_rows(0, static_cast<int>(m_samples.size()), enough_samples, m_wanted, m_rows,
                [&](int row) {
                    if (!bends(m_samples[static_cast<size_t>(row)])) return false;
                    place(row, boundary, x);
                    return true;
                });
    if (m_rows.empty()) return;
    proximity.query_rows(m_x, m_rows, boundary, m_near, chosen_at, {&m_ignored});
    for (const int row : m_rows) {
        if (!m_near.has(row) || !(m_near.distance[row] < reach)) continue;
        const RidgeContact found = ridge(row, chosen_at);
        if (agrees(found, contacts)) contacts.ridges.push_back(found);
    }
}

/// Where a sample is, and which limbs it passes over.
void RidgeFinder::place(int row, const Boundary& boundary, const Points& x) {
    const Sample& sample = m_samples[static_cast<size_t>(row)];
    LimbSet& ignored = m_ignored[static_cast<size_t>(row)] = 0;
    m_x.row(row).setZero();
    for (size_t c = 0; c < 3; ++c) {
        m_x.row(row) += sample.weight[c] * x.row(vertex(sample, c));
        if (sample.weight[c] > 0.0) ignored |= ignored_limbs(boundary, vertex(sample, c));
    }
}

/// Whether two corners of a face, or both ends of an edge, stand on skins that part.
bool RidgeFinder::bends(const Sample& sample) const {
    const auto bent = [&](size_t k) { return m_bent[static_cast<size_t>(sample.edge[k])] != 0; };
    return bent(0) || bent(1) || bent(2);
}

void RidgeFinder::find_bent_edges(const SurfaceContacts& contacts, StepEnd chosen_at) {
    const bool start = chosen_at == StepEnd::start;
    const Points& normals = start ? contacts.normal0 : contacts.normal1;
    const Points& points = start ? contacts.point0 : contacts.point1;
    for (size_t i = 0; i < m_in_reach.size(); ++i)
        m_in_reach[i] = in_reach(contacts, static_cast<int>(i));
    const int edge_count = static_cast<int>(m_edges.size());
#pragma omp parallel for if (edge_count >= enough_edges)
    for (int at = 0; at < edge_count; ++at) {
        const auto edge = static_cast<size_t>(at);
        const auto& [a, b] = m_edges[edge];
        m_bent[edge] = 0;
        if (!m_in_reach[static_cast<size_t>(a)] || !m_in_reach[static_cast<size_t>(b)]) continue;
        const double cosine = normals.row(a).dot(normals.row(b));
        if (!(cosine < smooth && cosine > opposite)) continue;
        // in a valley the normals lean towards each other
        m_bent[edge] = (normals.row(b) - normals.row(a)).dot(points.row(b) - points.row(a)) > 0.0;
    }
}

/// Whether a ridge faces the way that the skins under the face's vertices do; where it does not,
/// another limb is near and the cloth is pinched.
bool RidgeFinder::agrees(const RidgeContact& ridge, const SurfaceContacts& contacts) const {
    for (size_t c = 0; c < 3; ++c) {
        const int corner = m_faces(ridge.face, static_cast<int>(c));
        if (ridge.weight[c] > 0.0 && in_reach(contacts, corner) &&
            ridge.normal.dot(contacts.normal1.row(corner)) < opposite)
            return false;
    }
    return true;
}

RidgeContact RidgeFinder::ridge(int row, StepEnd chosen_at) const {
    const Sample& sample = m_samples[static_cast<size_t>(row)];
    RidgeContact ridge;
    ridge.face = sample.face;
    ridge.weight = sample.weight;
    ridge.normal = chosen_at == StepEnd::start ? carried_direction(m_near, row, m_x)
                                               : outward(m_near, row, m_x);
    ridge.height = ridge.normal.dot(m_near.point1.row(row).transpose());
    ridge.normal0 = turned(ridge.normal, m_near.normal1.row(row), m_near.normal0.row(row));
    ridge.point0 = m_near.point0.row(row);
    ridge.point1 = m_near.point1.row(row);
    return ridge;
}

}  // namespace cloth
