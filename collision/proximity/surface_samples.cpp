#include "collision/proximity/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "collision/geometry/select_rows.h"
#include "collision/proximity/direction.h"

namespace cloth {

constexpr double near_enough = 2e-2;  // m: skins further away do not matter
// A sample that is deep is no farther from the surface than its bound says. It is searched for
// somewhat farther: what is known of a face's centre saves the search for its edges' midpoints.
constexpr double beyond_doubt = 5e-3;  // m
constexpr int worth_threads = 4000;    // to be worth waking threads for

static std::vector<std::array<int, 2>> faces_at_edges(const Garment& garment) {
    std::map<std::pair<int, int>, int> index;
    const auto key = [](int a, int b) { return std::make_pair(std::min(a, b), std::max(a, b)); };
    for (size_t e = 0; e < garment.edges().size(); ++e)
        index[key(garment.edges()[e][0], garment.edges()[e][1])] = static_cast<int>(e);
    std::vector<std::array<int, 2>> result(garment.edges().size(), {-1, -1});
    const Faces& faces = garment.rest().faces;
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int k = 0; k < 3; ++k) {
            const int edge = index.at(key(faces(f, k), faces(f, (k + 1) % 3)));
            auto& at = result[static_cast<size_t>(edge)];
            at[at[0] < 0 ? 0 : 1] = static_cast<int>(f);
        }
    return result;
}

SurfaceSamples::SurfaceSamples(const Garment& garment)
    : m_faces(garment.rest().faces),
      m_edges(garment.edges()),
      m_edge_faces(faces_at_edges(garment)) {
    const Eigen::Index count = m_faces.rows() + static_cast<Eigen::Index>(m_edges.size());
    m_x.setZero(count, 3);
    m_radii.setZero(count);
    m_distance.setZero(count);  // what is not movable is never deep
    m_parted.resize(static_cast<size_t>(count));
    m_unsure.resize(static_cast<size_t>(count));
    m_ignored.resize(static_cast<size_t>(count));
    m_movable.resize(static_cast<size_t>(count));
    for (int sample = 0; sample < count; ++sample)
        for (const int vertex : corners(sample).vertex)
            if (!garment.is_pinned()[static_cast<size_t>(vertex)])
                m_movable[static_cast<size_t>(sample)] = 1;
    m_rows.reserve(static_cast<size_t>(count));
    m_deep.reserve(static_cast<size_t>(count));
    Proximity().query(m_x, Boundary(), m_contacts);  // gives the rows their size
}

SurfaceSamples::Corners SurfaceSamples::corners(int sample) const {
    if (sample < face_count()) {
        const double third = 1.0 / 3.0;
        return {{m_faces(sample, 0), m_faces(sample, 1), m_faces(sample, 2)},
                {third, third, third}};
    }
    const auto& [a, b] = m_edges[static_cast<size_t>(sample - face_count())];
    return {{a, b, b}, {0.5, 0.5, 0.0}};
}

SurfaceSamples::OnFace SurfaceSamples::on_face(int sample) const {
    const Corners at = corners(sample);
    if (sample < face_count()) return {sample, at.weight};
    OnFace on{m_edge_faces[static_cast<size_t>(sample - face_count())][0], {}};
    for (int k = 0; k < 3; ++k)
        for (int corner = 0; corner < at.count(); ++corner)
            if (m_faces(on.face, k) == at.vertex[static_cast<size_t>(corner)])
                on.weight[static_cast<size_t>(k)] = at.weight[static_cast<size_t>(corner)];
    return on;
}

Vec3 SurfaceSamples::way_out(int sample) const {
    return outward(m_contacts, sample, m_x);
}

double SurfaceSamples::max_depth() const {
    double depth = 0.0;
    for (const int sample : m_deep) depth = std::max(depth, -m_contacts.distance[sample]);
    return depth;
}

/// A sample is no farther from each of its vertices than their edges are long.
void SurfaceSamples::find_clear(const Points& x, const SurfaceContacts& contacts) {
    const Eigen::Index count = x.rows();
    m_clear.assign(static_cast<size_t>(count), 0);
    if (count == 0 || !(contacts.clearance.maxCoeff() > near_enough)) return;
    double squared = 0.0;
    for (const auto& [a, b] : m_edges)
        squared = std::max(squared, (x.row(a) - x.row(b)).squaredNorm());
    const double far_enough = std::max(near_enough, std::sqrt(squared));
    for (Eigen::Index i = 0; i < count; ++i)
        m_clear[static_cast<size_t>(i)] = contacts.clearance[i] > far_enough;
}

bool SurfaceSamples::is_clear(int sample) const {
    const auto at = corners(sample).vertex;
    return m_clear[static_cast<size_t>(at[0])] && m_clear[static_cast<size_t>(at[1])] &&
           m_clear[static_cast<size_t>(at[2])];
}

bool SurfaceSamples::has_changed(int sample, const std::vector<char>* changed) const {
    if (!m_movable[static_cast<size_t>(sample)]) return false;
    if (!changed) return true;
    for (const int vertex : corners(sample).vertex)
        if ((*changed)[static_cast<size_t>(vertex)]) return true;
    return false;
}

bool SurfaceSamples::skins_part(int sample, const SurfaceContacts& contacts) const {
    const auto at = corners(sample).vertex;
    const auto part = [&](int a, int b) {
        return std::min(contacts.distance[a], contacts.distance[b]) < near_enough &&
               contacts.normal1.row(a).dot(contacts.normal1.row(b)) < 0.0;
    };
    return part(at[0], at[1]) || part(at[1], at[2]) || part(at[2], at[0]);
}

double SurfaceSamples::vouched_by_vertices(int sample, const Points& x,
                                           const VectorX& clearance) const {
    double bound = -m_radius;
    for (const int vertex : corners(sample).vertex) {
        const double away = (m_x.row(sample) - x.row(vertex)).norm();
        bound = std::max(bound, clearance[vertex] - away);
        if (bound >= 0.0) break;  // enough to be sure
    }
    return bound;
}

double SurfaceSamples::vouched_by_faces(int edge) const {
    double bound = -m_radius;
    for (const int face : m_edge_faces[static_cast<size_t>(edge)]) {
        if (face < 0 || !m_movable[static_cast<size_t>(face)] ||
            m_parted[static_cast<size_t>(face)])
            continue;
        const double away = (m_x.row(face_count() + edge) - m_x.row(face)).norm();
        bound = std::max(bound, m_distance[face] - away);
    }
    return bound;
}

/// How far a sample is searched for, and what it passes over.
void SurfaceSamples::limit_search(int sample, const Boundary& boundary, double radius) {
    LimbSet ignored = 0;
    for (const int vertex : corners(sample).vertex) ignored |= ignored_limbs(boundary, vertex);
    m_ignored[static_cast<size_t>(sample)] = ignored;
    m_radii[sample] = radius;
}

void SurfaceSamples::query_rows(Proximity& proximity, const Boundary& boundary, double depth) {
    QueryLimits limits;
    limits.store_within = -depth;
    limits.ignored = &m_ignored;
    limits.radii = &m_radii;
    proximity.query_rows(m_x, m_rows, boundary, m_contacts, StepEnd::end, limits);
}

/// Searches for the nearest points of samples that may be deeper than `depth` (m).
template <class IsUnsure>
void SurfaceSamples::search_unsure(Proximity& proximity, const Boundary& boundary, int first,
                                   int last, double depth, const IsUnsure& is_unsure) {
    select_rows(first, last, worth_threads, m_unsure, m_rows, [&](int sample) {
        const bool unsure = is_unsure(sample);
        if (unsure) limit_search(sample, boundary, beyond_doubt - m_distance[sample]);
        return unsure;
    });
    query_rows(proximity, boundary, depth);
    for (const int sample : m_rows) m_distance[sample] = m_contacts.clearance[sample];
}

double SurfaceSamples::depth_beside(Proximity& proximity, const Boundary& boundary, const Points& x,
                                    const std::vector<char>& changed) {
    m_rows.clear();
    for (int sample = 0; sample < count(); ++sample) {
        if (!has_changed(sample, &changed)) continue;
        m_x.row(sample) = corners(sample).position(x);
        limit_search(sample, boundary, proximity.settings().radius);
        m_rows.push_back(sample);
    }
    query_rows(proximity, boundary, 0.0);
    double depth = 0.0;
    for (const int sample : m_rows)
        if (m_contacts.has(sample)) depth = std::max(depth, -m_contacts.distance[sample]);
    return depth;
}

void SurfaceSamples::find_deep(Proximity& proximity, const Boundary& boundary, const Points& x,
                               const SurfaceContacts& contacts, double depth,
                               const std::vector<char>* changed) {
    m_radius = proximity.settings().radius;
    find_clear(x, contacts);
    const auto is_unsure = [&](int sample) {
        const auto k = static_cast<size_t>(sample);
        if (!has_changed(sample, changed)) return false;
        if (is_clear(sample)) {
            m_parted[k] = 0;
            m_distance[sample] = 0.0;
            return false;
        }
        m_x.row(sample) = corners(sample).position(x);
        m_parted[k] = skins_part(sample, contacts);
        m_distance[sample] =
            m_parted[k] ? -m_radius : vouched_by_vertices(sample, x, contacts.clearance);
        return m_distance[sample] < -depth;
    };
    search_unsure(proximity, boundary, 0, face_count(), depth, is_unsure);
    search_unsure(proximity, boundary, face_count(), count(), depth, [&](int sample) {
        if (!is_unsure(sample)) return false;
        if (m_parted[static_cast<size_t>(sample)]) return true;
        m_distance[sample] = std::max(m_distance[sample], vouched_by_faces(sample - face_count()));
        return m_distance[sample] < -depth;
    });
    m_deep.clear();
    for (int sample = 0; sample < m_x.rows(); ++sample)
        if (m_distance[sample] < -depth) m_deep.push_back(sample);
}

}  // namespace cloth
