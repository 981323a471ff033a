#include "gnn/physics/xpbd/self_contact_planes.h"

#include <algorithm>

namespace cloth {

SelfContactPlanes::SelfContactPlanes(const Garment& garment, const SelfContactSettings& settings)
    : m_energy(garment, settings), m_inverse_masses(garment.inverse_masses()) {
}

void SelfContactPlanes::project(PaddedPoints& x) const {
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
        const Eigen::RowVector3d push = missing / mobility * pair.normal.transpose();
        for (size_t k = 0; k < 4; ++k)
            x.row(pair.vertex[k]).head<3>() +=
                pair.weight[k] * m_inverse_masses[pair.vertex[k]] * push;
    }
}

}  // namespace cloth
