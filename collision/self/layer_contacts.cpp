#include "collision/self/layer_contacts.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "collision/proximity/direction.h"
#include "data/core/check_range.h"

namespace cloth {
namespace {

constexpr int sweeps = 20;              // of CoulombContacts
constexpr double enough = 1e-5;         // m, and m/s: a sweep that moves less is the last
constexpr double recovery = 0.1;        // of what is missing to half the thickness, in a step
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
      m_contacts(mobilities(all, masses)) {
    check_layer_contacts(settings);
}

size_t LayerContacts::Hash::operator()(const Key& key) const {
    const auto wide = [](int part) { return static_cast<std::uint64_t>(part); };
    const std::uint64_t mixed =
        (wide(key[0]) << 62U ^ wide(key[1]) << 31U ^ wide(key[2])) * 0x9e3779b97f4a7c15U;
    return static_cast<size_t>(mixed ^ mixed >> 32U);
}

LayerContacts::Key LayerContacts::key_of(const SelfPair& pair) {
    return {pair.elements.edges ? 1 : 0, pair.elements.element[0], pair.elements.element[1]};
}

double LayerContacts::friction_of(const SelfPair& pair) const {
    const auto of = [&](int vertex) {
        return m_friction[static_cast<size_t>(m_part[static_cast<size_t>(vertex)])];
    };
    return std::max(of(pair.elements.vertex[0]), of(pair.elements.vertex[3]));
}

CoulombContacts::Contact LayerContacts::contact_of(const SelfPair& pair) const {
    CoulombContacts::Contact contact;
    contact.vertex = pair.elements.vertex;
    contact.weight = pair.weight;
    contact.normal = pair.normal;
    contact.friction = friction_of(pair);
    return contact;
}

LayerContacts::Report LayerContacts::resolve(const Points& x0, double distance, Outside* outside,
                                             Points& x, Points& v) {
    Report report;
    m_proximity.find(x0, x - x0, m_settings.thickness, m_settings.threads);
    m_touching = m_proximity.pairs();
    m_rows.clear();
    for (const SelfPair& pair : m_touching)
        m_rows.insert(m_rows.end(), pair.elements.vertex.begin(), pair.elements.vertex.end());
    sort_rows();
    if (outside && !m_rows.empty()) outside->push_out(m_rows, x);
    const auto contacts = [&]() -> const SurfaceContacts& {
        return outside ? outside->contacts() : m_none;
    };
    separate(x0, distance, contacts(), x);
    for (int pass = 0; pass < passes; ++pass) {
        const SelfResolveReport resolved = m_resolver.resolve(x0, contacts(), distance, x);
        report.crossings += resolved.crossings;
        report.left = resolved.left;
        m_touching.insert(m_touching.end(), m_resolver.pairs().begin(), m_resolver.pairs().end());
        if (pass > 0) m_rows.clear();
        m_rows.insert(m_rows.end(), m_resolver.moved().begin(), m_resolver.moved().end());
        sort_rows();
        if (!outside || m_rows.empty() || pass + 1 == passes) break;
        if (outside->push_out(m_rows, x) < fair_depth) break;
    }
    report.pairs = slow_down(v);
    return report;
}

void LayerContacts::sort_rows() {
    std::sort(m_rows.begin(), m_rows.end());
    m_rows.erase(std::unique(m_rows.begin(), m_rows.end()), m_rows.end());
}

/// Pairs that come nearer than half the thickness.
void LayerContacts::separate(const Points& x0, double distance, const SurfaceContacts& outside,
                             Points& x) {
    const std::vector<SelfPair>& pairs = m_proximity.pairs();
    m_contacts.clear();
    for (const SelfPair& pair : pairs) {
        CoulombContacts::Contact contact = contact_of(pair);
        contact.friction = 0.0;  // positions follow velocities, which rub
        const double before = pair.distance_at(x0), kept = 0.5 * m_settings.thickness;
        contact.height = before < kept ? before + recovery * (kept - before) : kept;
        if (pair.distance_at(x) < contact.height) m_contacts.add(contact);
    }
    if (m_contacts.size() == 0) return;
    if (!outside.obstacle.empty())
        for (const int i : m_rows) {
            if (!outside.has(i) || !(outside.distance[i] < hold_distance)) continue;
            CoulombContacts::Contact plane{
                {i, i, i, i}, {1.0, 0.0, 0.0, 0.0}, outward(outside, i, x)};
            plane.height = plane.normal.dot(outside.point1.row(i)) + distance;
            m_contacts.add(plane);
        }
    m_contacts.solve(sweeps, enough, x);
}

/// Returns the number of pairs that push each other.
int LayerContacts::slow_down(Points& v) {
    m_contacts.clear();
    m_index.clear();
    m_index.reserve(m_lasting.size() + m_touching.size());
    for (const Lasting& lasting : m_lasting) {
        CoulombContacts::Contact contact = contact_of(lasting.pair);
        contact.push = lasting.push;
        contact.rub = lasting.rub;
        m_index.emplace(key_of(lasting.pair), m_contacts.size());
        m_contacts.add(contact);
    }
    for (const SelfPair& pair : m_touching)
        if (m_index.emplace(key_of(pair), m_contacts.size()).second)
            m_contacts.add(contact_of(pair));
    m_contacts.solve(sweeps, enough, v);
    remember();
    return static_cast<int>(m_pushes.size());
}

/// What was pushed in the step before, too, lasts: as far as it was the less.
void LayerContacts::remember() {
    m_lasting.clear();
    ByPair<double> pushes;
    pushes.reserve(m_touching.size());
    for (const SelfPair& pair : m_touching) {
        const Key key = key_of(pair);
        const size_t contact = m_index.at(key);
        const double push = m_contacts.push(contact);
        if (!(push > 0.0) || !pushes.emplace(key, push).second) continue;
        const auto before = m_pushes.find(key);
        if (before == m_pushes.end()) continue;
        const double lasts = std::min(push, before->second);
        const Vec3 rub = m_contacts.rub(contact);
        m_lasting.push_back(
            {pair, lasts, (lasts / push) * (rub - rub.dot(pair.normal) * pair.normal)});
    }
    m_pushes.swap(pushes);
}

const Points& LayerContacts::forecast(double scale) {
    m_forecast.setZero(static_cast<Eigen::Index>(m_part.size()), 3);
    for (Lasting& lasting : m_lasting) {
        lasting.push *= scale;
        lasting.rub *= scale;
        const Vec3 impulse = lasting.push * lasting.pair.normal + lasting.rub;
        for (size_t k = 0; k < 4; ++k)
            m_forecast.row(lasting.pair.elements.vertex[k]) +=
                lasting.pair.weight[k] * impulse.transpose();
    }
    return m_forecast;
}

}  // namespace cloth
