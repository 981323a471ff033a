#include "bullet_ext/materialFabric.h"

#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cmath>

namespace cloth {

namespace {

/// Mean m_kLST of the links of one kind, 0 to 1; `otherwise` if there are none.
double meanStiffness(const btSoftBody& body, bool bending, double otherwise) {
    double sum = 0.0;
    int count = 0;
    for (int l = 0; l < body.m_links.size(); ++l) {
        const btSoftBody::Link& link = body.m_links[l];
        if ((link.m_bbending != 0) != bending || !link.m_material) continue;
        const double stiffness = link.m_material->m_kLST;
        if (!std::isfinite(stiffness)) continue;
        sum += std::clamp(stiffness, 0.0, 1.0);
        ++count;
    }
    return count ? sum / count : otherwise;
}

}  // namespace

Fabric fabricOfMaterials(const btSoftBody& body, double density) {
    constexpr double kSoft = 33.0, kReal = 5000.0, kPoisson = 0.3;
    constexpr double kNone = -1.0;
    const double young = kSoft * std::pow(kReal / kSoft, meanStiffness(body, false, 1.0));
    const double bending = meanStiffness(body, true, kNone);
    Fabric fabric;
    fabric.density = density;
    fabric.mu = young / (2.0 * (1.0 + kPoisson));
    fabric.lambda = young * kPoisson / (1.0 - kPoisson * kPoisson);
    fabric.bending = bending == kNone ? 4e-6 : 4e-5 * std::pow(10.0, bending);
    return fabric;
}

}  // namespace cloth
