#include "gnn/physics/xpbd/self_contact_planes.h"

#include <algorithm>

namespace cloth {

SelfContactPlanes::SelfContactPlanes(const Garment& garment, const SelfContactSettings& settings)
    : m_energy(garment, settings), m_inverse_masses(garment.inverse_masses()) {
}

void SelfContactPlanes::project(const PaddedPoints& before, PaddedPoints& x) const {
    for (const SelfContactEnergy::Pair& pair : m_energy.pairs()) {
        Eigen::RowVector4d offset = Eigen::RowVector4d::Zero();
        double mobility = 0.0;
        for (size_t k = 0; k < 4; ++k) {
            offset += pair.weight[k] * x.row(pair.vertex[k]);
            mobility += pair.weight[k] * pair.weight[k] * m_inverse_masses[pair.vertex[k]];
        }
        const double distance = offset.head<3>().dot(pair.normal.transpose());
        const double missing = std::min(m_energy.thickness(), pair.start) - distance;
        if (!(missing > 0.0 && mobility > 0.0)) continue;
        Eigen::RowVector4d motion = offset;
        for (size_t k = 0; k < 4; ++k) motion -= pair.weight[k] * before.row(pair.vertex[k]);
        const Vec3 moved = motion.head<3>();
        const Vec3 slip = moved - pair.normal.dot(moved) * pair.normal;
        const double length = slip.norm(), limit = m_energy.friction() * missing;
        const double taken = length > limit ? limit / length : 1.0;
        const Eigen::RowVector3d push =
            (missing * pair.normal - taken * slip).transpose() / mobility;
        for (size_t k = 0; k < 4; ++k)
            x.row(pair.vertex[k]).head<3>() +=
                pair.weight[k] * m_inverse_masses[pair.vertex[k]] * push;
    }
}

}  // namespace cloth
