#include "data/authoring/body_sections.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cloth {

BodySections::BodySections(const TriMesh& body, Settings settings)
    : m_settings(std::move(settings)) {
    const int slices = static_cast<int>(std::ceil((m_settings.high - m_settings.low) / kStep)) + 1;
    m_support.assign(static_cast<size_t>(slices), {});
    for (auto& slice : m_support) slice.fill(-1.0);
    for (int d = 0; d < kDirections; ++d) {
        const double angle = 2.0 * M_PI * d / kDirections;
        m_directions[static_cast<size_t>(d)] = {std::cos(angle), std::sin(angle)};
    }
    for (Eigen::Index f = 0; f < body.faces.rows(); ++f)
        for (int c = 0; c < 3; ++c)
            add_edge(body.vertices.row(body.faces(f, c)),
                     body.vertices.row(body.faces(f, (c + 1) % 3)));
    freeze();
    drape();
    if (m_settings.flare) hang();
    smooth_heights();
}

double BodySections::operator()(const Vec3& p) const {
    const double at = (p.y() - m_settings.low) / kStep;
    const int last = static_cast<int>(m_support.size()) - 2;
    const int slice = std::clamp(static_cast<int>(std::floor(at)), 0, last);
    const double t = std::clamp(at - slice, 0.0, 1.0);
    const auto& a = m_support[static_cast<size_t>(slice)];
    const auto& b = m_support[static_cast<size_t>(slice) + 1];
    const Vec3 axis = m_settings.axis(p.y());
    double value = -1.0;
    for (size_t d = 0; d < kDirections; ++d)
        value = std::max(value, (p.x() - axis.x()) * m_directions[d][0] +
                                    (p.z() - axis.z()) * m_directions[d][1] -
                                    ((1.0 - t) * a[d] + t * b[d]));
    return value;
}

double BodySections::widest() const {
    double widest = 0.0;
    for (const Slice& slice : m_support)
        widest = std::max(widest, *std::max_element(slice.begin(), slice.end()));
    return widest;
}

void BodySections::add_edge(const Vec3& p, const Vec3& q) {
    if (p.y() > q.y()) return;  // the other face's half of the edge does it
    const int first = std::max(0, static_cast<int>(std::ceil((p.y() - m_settings.low) / kStep)));
    for (int s = first; s < static_cast<int>(m_support.size()); ++s) {
        const double y = height(s);
        if (y > q.y()) break;
        const double t = (y - p.y()) / std::max(1e-12, q.y() - p.y());
        const Vec3 x = p + t * (q - p);
        if (const auto counted = m_settings.belongs(x.x(), y)) {
            const Vec3 axis = m_settings.axis(y);
            add_point(m_support[static_cast<size_t>(s)], *counted - axis.x(), x.z() - axis.z());
        }
    }
}

void BodySections::add_point(Slice& slice, double x, double z) const {
    for (size_t d = 0; d < kDirections; ++d)
        slice[d] = std::max(slice[d], x * m_directions[d][0] + z * m_directions[d][1]);
}

void BodySections::freeze() {
    const int count = static_cast<int>(m_support.size());
    const int frozen =
        std::clamp(static_cast<int>(std::ceil((m_settings.freeze_below - m_settings.low) / kStep)),
                   0, count - 1);
    for (int s = 0; s < frozen; ++s)
        m_support[static_cast<size_t>(s)] = m_support[static_cast<size_t>(frozen)];
}

/// The profile of each direction is closed with a disc: cloth hangs straight over hollows.
void BodySections::drape() {
    const int count = std::min(static_cast<int>(m_support.size()),
                               static_cast<int>((m_settings.drape_below - m_settings.low) / kStep));
    if (count <= 0) return;
    const int reach = static_cast<int>(0.25 / kStep);
    const double r = m_settings.drape_radius;
    const auto arc = [&](int steps) {
        const double dy = steps * kStep;
        return r - std::sqrt(r * r - dy * dy);
    };
    std::vector<double> disc(static_cast<size_t>(count));
    for (size_t d = 0; d < kDirections; ++d) {
        for (int s = 0; s < count; ++s) {  // lowest centre of a disc that clears the profile
            double height = -1.0;
            for (int n = std::max(0, s - reach); n < std::min(count, s + reach + 1); ++n)
                height = std::max(height,
                                  m_support[static_cast<size_t>(n)][d] + r - arc(std::abs(n - s)));
            disc[static_cast<size_t>(s)] = height;
        }
        for (int s = 0; s < count; ++s) {  // what the discs leave
            double height = 1e9;
            for (int n = std::max(0, s - reach); n < std::min(count, s + reach + 1); ++n)
                height = std::min(height, disc[static_cast<size_t>(n)] - r + arc(std::abs(n - s)));
            double& support = m_support[static_cast<size_t>(s)][d];
            support = std::max(support, height);
        }
    }
}

/// Cloth falls from the widest place above, and widens.
void BodySections::hang() {
    constexpr double onset = 0.1;  // the flare begins softly over this height (m)
    const auto widening = [&](double y) {
        const double below = std::max(0.0, m_settings.flare_from - y);
        const double soft = std::min(below, onset);
        return *m_settings.flare * (soft * soft / (2.0 * onset) + below - soft);
    };
    const int count = static_cast<int>(m_support.size());
    for (int s = count - 2; s >= 0; --s)
        if (height(s) < m_settings.hang_from)
            for (size_t d = 0; d < kDirections; ++d)
                m_support[static_cast<size_t>(s)][d] = std::max(
                    m_support[static_cast<size_t>(s)][d], m_support[static_cast<size_t>(s) + 1][d]);
    for (int s = 0; s < count; ++s)
        for (double& support : m_support[static_cast<size_t>(s)]) support += widening(height(s));
}

void BodySections::smooth_heights() {
    for (int pass = 0; pass < 8; ++pass) {
        const std::vector<Slice> old = m_support;
        for (size_t s = 1; s + 1 < old.size(); ++s)
            for (size_t d = 0; d < kDirections; ++d)
                m_support[s][d] = 0.25 * old[s - 1][d] + 0.5 * old[s][d] + 0.25 * old[s + 1][d];
    }
}

}  // namespace cloth
