#include "data/authoring/sleeve.h"

#include <algorithm>

namespace cloth {

namespace {

/// The farthest skin of the left arm from the line between two joints, on a part of its length.
double widest(const TriMesh& body, const BodyLandmarks& marks, const Vec3& from, const Vec3& axis,
              double length, double begin, double end) {
    double widest = 0.0;
    for (Eigen::Index i = 0; i < body.vertices.rows(); ++i) {
        const Vec3 p = body.vertices.row(i);
        const double along = (p - from).dot(axis) / length;
        const double away = ((p - from) - along * length * axis).norm();
        const bool on_arm = p.x() > marks.armpit.x() + 0.015 && away < 0.09;
        if (on_arm && along > begin && along < end) widest = std::max(widest, away);
    }
    return widest;
}

}  // namespace

double Sleeve::Part::operator()(const Vec3& p) const {
    const double along = std::clamp((p - from).dot(axis), 0.0, length);
    return (p - from - along * axis).norm() - (radius - narrowing * (along / length));
}

Sleeve::Sleeve(const TriMesh& body, const BodyLandmarks& marks, const GarmentRecipe& recipe)
    : m_has_fore(recipe.sleeve_length > 1.0) {
    m_upper.from = marks.shoulder;
    m_upper.axis = marks.elbow - marks.shoulder;
    m_upper.length = m_upper.axis.norm();
    m_upper.axis /= m_upper.length;
    m_upper.radius = widest(body, marks, m_upper.from, m_upper.axis, m_upper.length, 0.3,
                            std::min(recipe.sleeve_length, 0.95) + 0.05) +
                     recipe.sleeve_ease;
    if (!m_has_fore) return;
    m_fore.from = marks.elbow;
    m_fore.axis = marks.wrist - marks.elbow;
    m_fore.length = m_fore.axis.norm();
    m_fore.axis /= m_fore.length;
    const auto radius = [&](double begin, double end) {
        return widest(body, marks, m_fore.from, m_fore.axis, m_fore.length, begin, end) +
               recipe.sleeve_ease;
    };
    m_fore.radius = radius(0.15, 0.5);
    m_fore.narrowing = m_fore.radius - radius(0.8, 1.0);
}

double Sleeve::operator()(const Vec3& p) const {
    return m_has_fore ? std::min(m_upper(p), m_fore(p)) : m_upper(p);
}

SleeveEnd sleeve_end(const BodyLandmarks& marks, const GarmentRecipe& recipe) {
    const bool fore = recipe.sleeve_length > 1.0;
    const Vec3& from = fore ? marks.elbow : marks.shoulder;
    const Vec3 part = (fore ? marks.wrist : marks.elbow) - from;
    return {from + (fore ? recipe.sleeve_length - 1.0 : recipe.sleeve_length) * part,
            part.normalized()};
}

}  // namespace cloth
