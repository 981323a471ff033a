#include "gnn/physics/solver/contact_hessian.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cloth {
namespace {

// Both limits were chosen by the energy gap after 3 and 10 iterations of soft and real cotton on a
// sphere; a factor of four either way costs a tenth. A vertex at rest on a surface is about 0.02 mm
// deep, so a stiffness of 0.05 mm is more than its weight needs and no more than P's own.
constexpr double anticipated_depth = 5e-5;  // m
constexpr double depth_per_step = 1e-4;     // m

}  // namespace

void ContactHessian::begin_step(const IncrementalPotential& potential,
                                const std::vector<int>& row_of) {
    begin_vertices(potential, row_of);
    m_ridges.clear();
    for (const RidgeEnergy::Plane& plane : potential.ridges().planes()) {
        Ridge ridge{plane.vertex, {}, plane.weight, plane.normal, plane.offset};
        for (size_t k = 0; k < 3; ++k) {
            ridge.row[k] = row_of[static_cast<size_t>(plane.vertex[k])];
            // what does not move has no part in the blocks
            if (ridge.row[k] < 0) ridge.row[k] = 0, ridge.weight[k] = 0.0;
        }
        m_ridges.push_back(ridge);
    }
    begin_self_contact(potential.self_contact(), row_of);
    m_goals.begin_step(potential.goals(), row_of);
}

void ContactHessian::begin_vertices(const IncrementalPotential& potential,
                                    const std::vector<int>& row_of) {
    m_blocks.clear();
    m_anticipated = false;
    m_contacts.clear();
    m_sliders.clear();
    m_slider_index.clear();
    m_vertex_of.resize(row_of.size());
    size_t rows = 0;
    for (size_t i = 0; i < row_of.size(); ++i) {
        if (row_of[i] < 0) continue;
        m_vertex_of[static_cast<size_t>(row_of[i])] = static_cast<int>(i);
        ++rows;
    }
    const auto& sliders = potential.friction().sliders();
    m_slider_of.assign(rows, -1);
    for (size_t k = 0; k < sliders.size(); ++k)
        if (const int row = row_of[static_cast<size_t>(sliders[k].vertex)]; row >= 0)
            m_slider_of[static_cast<size_t>(row)] = static_cast<int>(k);

    const SurfaceContacts& near = potential.contacts();
    const double distance = potential.settings().contact_distance;
    for (size_t k = 0; k < rows; ++k) {
        const int row = static_cast<int>(k), vertex = m_vertex_of[k];
        if (!near.obstacle.empty() && near.has(vertex)) {
            const Vec3 normal = near.normal1.row(vertex);
            m_contacts.push_back(
                {vertex, row, normal, distance + near.point1.row(vertex).dot(normal)});
        }
        if (m_slider_of[k] < 0) continue;
        m_slider_index.push_back(static_cast<size_t>(m_slider_of[k]));
        m_sliders.push_back({row, sliders[m_slider_index.back()].normal});
    }
}

void ContactHessian::begin_self_contact(const SelfContactEnergy& energy,
                                        const std::vector<int>& row_of) {
    m_self = &energy;
    m_self_contacts.clear();
    if (std::all_of(row_of.begin(), row_of.end(), [](int row) { return row < 0; })) return;
    for (const SelfContactEnergy::Pair& pair : energy.pairs()) {
        SelfContact contact{{}, pair.weight, pair.normal, pair.stiffness};
        for (size_t k = 0; k < 4; ++k) {
            contact.row[k] = row_of[static_cast<size_t>(pair.vertex[k])];
            // what does not move has no part in the blocks
            if (contact.row[k] < 0) contact.row[k] = 0, contact.weight[k] = 0.0;
        }
        m_self_contacts.push_back(contact);
    }
    if (m_lumps) m_edge_pairs.begin_step(energy, row_of.size());
}

double ContactHessian::SelfContact::along(const Points& direction) const {
    const auto at = [&](size_t k) { return weight[k] * direction.row(row[k]); };
    return (at(0) + at(1) + at(2) + at(3)).dot(normal.transpose());
}

void ContactHessian::linearise(const IncrementalPotential& potential, const Points& x) {
    m_weight = potential.settings().contact_weight;
    m_blocks.clear();
    m_anticipated = false;
    for (Contact& contact : m_contacts) {
        contact.depth = contact.surface - x.row(contact.vertex).dot(contact.normal);
        contact.stiffness = 6.0 * m_weight * std::max(contact.depth, 0.0);
    }
    const auto& planes = potential.ridges().planes();
    for (size_t k = 0; k < m_ridges.size(); ++k) {
        m_ridges[k].depth = planes[k].depth(x);
        m_ridges[k].stiffness = RidgeEnergy::law(m_ridges[k].depth, m_weight).stiffness;
    }
    const FrictionEnergy& friction = potential.friction();
    for (size_t k = 0; k < m_sliders.size(); ++k) {
        const FrictionEnergy::Slider& slider = friction.sliders()[m_slider_index[k]];
        const Vec3 motion = x.row(slider.vertex).transpose() - slider.stick;
        const Vec3 slip = motion - slider.normal.dot(motion) * slider.normal;
        const double smooth = std::sqrt(friction.slip() * friction.slip() + slip.squaredNorm());
        m_sliders[k].stiffness = slider.force / smooth;
        m_sliders[k].yielding = std::sqrt(m_sliders[k].stiffness) / smooth * slip;
    }
    if (m_goals.active()) m_goals.linearise(x);
    if (m_self_contacts.empty()) return;
    const LayerFriction& layers = potential.layer_friction();
    for (const LayerFriction::Slider& slider : layers.sliders())
        m_self_contacts[slider.pair].friction = slider.force / layers.smoothed(slider.slip(x));
    m_from = x;
    for (size_t k = 0; k < m_self_contacts.size(); ++k) {
        SelfContact& contact = m_self_contacts[k];
        contact.depth = m_self->thickness() - m_self->pairs()[k].distance(x);
        contact.stiffness = 6.0 * contact.pair_weight * std::max(contact.depth, 0.0);
    }
}

/// Slope of the secant of the force 3 w depth^2, up to the anticipated depth.
double ContactHessian::secant(double weight, double before, double after) {
    return 3.0 * weight * (before + std::min(after, before + anticipated_depth));
}

bool ContactHessian::anticipate(const Points& step) {
    bool any = !m_sliders.empty();
    for (Contact& contact : m_contacts) {
        const double before = std::max(contact.depth, 0.0);
        const double after = contact.depth - step.row(contact.row).dot(contact.normal);
        if (after > before) contact.stiffness = secant(m_weight, before, after);
        any = any || contact.stiffness > 0.0;
    }
    for (Ridge& ridge : m_ridges) {
        const double before = std::max(ridge.depth, 0.0);
        const double after = std::min(ridge.depth - rise(ridge, step), before + anticipated_depth);
        if (after > before)
            ridge.stiffness = (RidgeEnergy::law(after, m_weight).force -
                               RidgeEnergy::law(before, m_weight).force) /
                              (after - before);
        any = any || ridge.stiffness > 0.0;
    }
    for (SelfContact& contact : m_self_contacts) {
        const double before = std::max(contact.depth, 0.0);
        const double after = contact.depth - contact.along(step);
        if (after > before) contact.stiffness = secant(contact.pair_weight, before, after);
        any = any || contact.stiffness > 0.0 || contact.friction > 0.0;
    }
    if (!m_self_contacts.empty()) lump_edge_pairs();
    if (m_goals.active()) m_goals.anticipate(step);
    gather_blocks();
    m_anticipated = true;
    return any || !m_goals.blocks().empty();
}

void ContactHessian::lump_edge_pairs() {
    for (const LumpedEdgePairs::Lumped& lumped : m_edge_pairs.lumped()) {
        SelfContact& edges = m_self_contacts[lumped.pair];
        for (size_t k = 0; k < 4; ++k) {
            SelfContact& of_vertex = m_self_contacts[lumped.to[k]];
            of_vertex.stiffness += lumped.share[k] * edges.stiffness;
            of_vertex.friction += lumped.share[k] * edges.friction;
        }
        edges.stiffness = edges.friction = 0.0;
    }
}

void ContactHessian::gather_blocks() {
    m_blocks.clear();
    const auto at = [&](int row) -> Stiffness& {
        if (m_blocks.empty() || m_blocks.back().row != row) m_blocks.push_back({row, {}});
        return m_blocks.back().stiffness;
    };
    auto slider = m_sliders.begin();
    const auto add_sliders = [&](int end) {
        for (; slider != m_sliders.end() && slider->row < end; ++slider) {
            at(slider->row).add(slider->normal, 0.0, slider->stiffness);
            at(slider->row).subtract(slider->yielding);
        }
    };
    for (const Contact& contact : m_contacts) {
        if (!(contact.stiffness > 0.0)) continue;
        add_sliders(contact.row);
        at(contact.row).add(contact.normal, contact.stiffness, 0.0);
        add_sliders(contact.row + 1);
    }
    add_sliders(std::numeric_limits<int>::max());
    for (const GoalHessian::Block& goal : m_goals.blocks()) at(goal.row).add(goal.stiffness);
}

/// Of the point of a ridge, along its normal (m).
double ContactHessian::rise(const Ridge& ridge, const Points& step) {
    double rise = 0.0;
    for (size_t k = 0; k < 3; ++k)
        rise += ridge.weight[k] * step.row(ridge.row[k]).dot(ridge.normal);
    return rise;
}

void ContactHessian::add_product(const Points& direction, Points& product) const {
    for (const Block& block : m_blocks)
        product.row(block.row) += (block.stiffness * Vec3(direction.row(block.row))).transpose();
    for_each_coupling([&](const Coupling& coupling) {
        Vec3 motion = Vec3::Zero();
        for (size_t k = 0; k < 4; ++k)
            motion += coupling.weight[k] * direction.row(coupling.row[k]).transpose();
        const double apart = coupling.normal.dot(motion);
        const Vec3 force =
            coupling.across * motion + (coupling.along - coupling.across) * apart * coupling.normal;
        for (size_t k = 0; k < 4; ++k)
            product.row(coupling.row[k]) += coupling.weight[k] * force.transpose();
    });
}

void ContactHessian::limit_depth(Points& trial) const {
    for (const Contact& contact : m_contacts) {
        const double limit = std::max(contact.depth, 0.0) + depth_per_step;
        const double depth = contact.surface - trial.row(contact.vertex).dot(contact.normal);
        if (depth > limit)
            trial.row(contact.vertex) += (depth - limit) * contact.normal.transpose();
    }
    if (!m_self_contacts.empty()) m_self->limit_entry(m_from, trial);
    if (m_goals.active()) m_goals.limit(trial);
}

}  // namespace cloth
