#include "collision/self/layer_contacts.h"

#include <algorithm>
#include <utility>

#include "collision/proximity/direction.h"
#include "data/core/check_range.h"

namespace cloth {
namespace {

constexpr int sweeps = 60;              // of CoulombContacts
constexpr double enough = 1e-6;         // m, and m/s: a sweep that moves less is the last
constexpr double recovery = 0.1;        // of what is missing to the thickness, made up in a step
constexpr double hold_distance = 1e-2;  // m: vertices farther from obstacles need no holding
constexpr int passes = 3;               // layers, obstacles, layers, ...: layers have the last word
constexpr double fair_depth = 1e-6;     // m: vertices less deep in an obstacle are at its surface

SelfContactSettings resolver_settings(const LayerContactSettings& settings) {
    SelfContactSettings result;
    result.thickness = settings.thickness;
    result.threads = settings.threads;
    return result;
}

FaceParts parts_of_faces(const Garment& all, const std::vector<int>& part) {
    const Faces& faces = all.rest().faces;
    std::vector<int> result(static_cast<size_t>(faces.rows()));
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        result[static_cast<size_t>(f)] = part[static_cast<size_t>(faces(f, 0))];
    return FaceParts(std::move(result));
}

VectorX mobilities(const Garment& all, const VectorX& masses) {
    VectorX result = masses.cwiseInverse();
    for (const int pin : all.pins()) result[pin] = 0.0;
    return result;
}

CoulombContacts::Contact contact_of(const SelfPair& pair, double friction) {
    CoulombContacts::Contact contact;
    contact.vertex = pair.elements.vertex;
    contact.weight = pair.weight;
    contact.normal = pair.normal;
    contact.friction = friction;
    return contact;
}

}  // namespace

void check_layer_contacts(const LayerContactSettings& settings) {
    check_range("LayerContactSettings.thickness", settings.thickness, 1e-3, 2e-2);
    check_range("LayerContactSettings.threads", settings.threads, 0, 1024);
}

LayerContacts::LayerContacts(const Garment& all, std::vector<int> part, const VectorX& masses,
                             std::vector<double> friction, const LayerContactSettings& settings)
    : m_settings(settings),
      m_part(std::move(part)),
      m_friction(std::move(friction)),
      m_proximity(all, settings.thickness, parts_of_faces(all, m_part)),
      m_resolver(all, resolver_settings(settings), masses, parts_of_faces(all, m_part)),
      m_contacts(mobilities(all, masses)),
      m_held(m_part.size(), 0) {
    check_layer_contacts(settings);
}

double LayerContacts::friction_of(const SelfPair& pair) const {
    const auto of = [&](int vertex) {
        return m_friction[static_cast<size_t>(m_part[static_cast<size_t>(vertex)])];
    };
    return std::max(of(pair.elements.vertex[0]), of(pair.elements.vertex[3]));
}

LayerContacts::Report LayerContacts::resolve(const Points& x0, double distance, Outside* outside,
                                             Points& x, Points& v) {
    Report report;
    m_pushed.clear();
    m_proximity.find(x0, x - x0, m_settings.thickness, m_settings.threads);
    m_rows.clear();
    for (const SelfPair& pair : m_proximity.pairs())
        m_rows.insert(m_rows.end(), pair.elements.vertex.begin(), pair.elements.vertex.end());
    std::sort(m_rows.begin(), m_rows.end());
    m_rows.erase(std::unique(m_rows.begin(), m_rows.end()), m_rows.end());
    if (outside && !m_rows.empty()) outside->push_out(m_rows, x);
    const auto contacts = [&]() -> const SurfaceContacts& {
        return outside ? outside->contacts() : m_none;
    };
    separate(x0, distance, contacts(), x);
    report.pairs = static_cast<int>(m_pushed.size());
    for (int pass = 0; pass < passes; ++pass) {
        const SelfResolveReport resolved = m_resolver.resolve(x0, contacts(), distance, x);
        report.crossings += resolved.crossings;
        report.left = resolved.left;
        m_pushed.insert(m_pushed.end(), m_resolver.pairs().begin(), m_resolver.pairs().end());
        if (pass == 0)
            m_rows.insert(m_rows.end(), m_resolver.moved().begin(), m_resolver.moved().end());
        else
            m_rows = m_resolver.moved();
        if (!outside || m_rows.empty() || pass + 1 == passes) break;
        if (outside->push_out(m_rows, x) < fair_depth) break;
    }
    if (!m_pushed.empty()) slow_down(v);
    return report;
}

void LayerContacts::separate(const Points& x0, double distance, const SurfaceContacts& outside,
                             Points& x) {
    const std::vector<SelfPair>& pairs = m_proximity.pairs();
    if (pairs.empty()) return;
    m_contacts.clear();
    for (const SelfPair& pair : pairs) {
        CoulombContacts::Contact contact = contact_of(pair, friction_of(pair));
        const double missing = m_settings.thickness - pair.distance;
        contact.height = missing > 0.0 ? pair.distance + recovery * missing : m_settings.thickness;
        for (size_t k = 0; k < 4; ++k)
            contact.target += pair.weight[k] * x0.row(pair.elements.vertex[k]).transpose();
        m_contacts.add(contact);
    }
    if (!outside.obstacle.empty())
        for (const int i : m_rows) {
            if (!outside.has(i) || !(outside.distance[i] < hold_distance)) continue;
            CoulombContacts::Contact plane{
                {i, i, i, i}, {1.0, 0.0, 0.0, 0.0}, outward(outside, i, x)};
            plane.height = plane.normal.dot(outside.point1.row(i)) + distance;
            m_contacts.add(plane);
        }
    m_contacts.solve(sweeps, enough, x);
    for (size_t p = 0; p < pairs.size(); ++p)
        if (m_contacts.push(p) > 0.0) m_pushed.push_back(pairs[p]);
}

void LayerContacts::slow_down(Points& v) {
    m_contacts.clear();
    for (const SelfPair& pair : m_pushed) m_contacts.add(contact_of(pair, friction_of(pair)));
    m_contacts.solve(sweeps, enough, v);
}

}  // namespace cloth
