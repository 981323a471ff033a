#include "gnn/physics/energy/layer_friction.h"

#include <algorithm>

namespace cloth {

void LayerFriction::begin_step(const SelfContactEnergy& contact, const Points& x, double slip,
                               double force_per_mass) {
    m_sliders.clear();
    m_slip = slip;
    if (!(contact.friction() > 0.0)) return;
    for (size_t index = 0; index < contact.pairs().size(); ++index) {
        const SelfContactEnergy::Pair& pair = contact.pairs()[index];
        const double depth = contact.thickness() - pair.start;
        if (!(depth > 0.0)) continue;
        const double pressed =
            std::min(3.0 * pair.stiffness * depth * depth, force_per_mass * pair.mass);
        if (!(pressed > 0.0)) continue;
        Slider slider{
            pair.vertex, pair.weight, pair.normal, Vec3::Zero(), contact.friction() * pressed,
            index};
        for (size_t k = 0; k < 4; ++k)
            slider.start += pair.weight[k] * x.row(pair.vertex[k]).transpose();
        m_sliders.push_back(slider);
    }
}

double LayerFriction::value(const Points& x) const {
    double energy = 0.0;
    for (const Slider& slider : m_sliders)
        energy += slider.force * (smoothed(slider.slip(x)) - m_slip);
    return energy;
}

double LayerFriction::add_gradient(const Points& x, Points& gradient) const {
    double energy = 0.0;
    for (const Slider& slider : m_sliders) {
        const Vec3 slip = slider.slip(x);
        const double length = smoothed(slip);
        const Eigen::RowVector3d force = (slider.force / length) * slip.transpose();
        for (size_t k = 0; k < 4; ++k) gradient.row(slider.vertex[k]) += slider.weight[k] * force;
        energy += slider.force * (length - m_slip);
    }
    return energy;
}

void LayerFriction::add_hessian(const Points& x, const std::vector<char>& pinned,
                                Eigen::SparseMatrix<double>& hessian) const {
    if (m_sliders.empty()) return;
    const auto is_pinned = [&](int vertex) { return pinned[static_cast<size_t>(vertex)] != 0; };
    for (const Slider& slider : m_sliders) {
        const Vec3 slip = slider.slip(x);
        const double length = smoothed(slip);
        const Eigen::Matrix3d tangent =
            Eigen::Matrix3d::Identity() - slider.normal * slider.normal.transpose();
        const Eigen::Matrix3d block =
            slider.force / length * (tangent - slip * slip.transpose() / (length * length));
        for (size_t a = 0; a < 4; ++a)
            for (size_t b = 0; b < 4; ++b) {
                if (is_pinned(slider.vertex[a]) || is_pinned(slider.vertex[b])) continue;
                const double weight = slider.weight[a] * slider.weight[b];
                for (int i = 0; i < 3; ++i)
                    for (int j = 0; j < 3; ++j)
                        hessian.coeffRef(3 * slider.vertex[a] + i, 3 * slider.vertex[b] + j) +=
                            weight * block(i, j);
            }
    }
}

}  // namespace cloth
