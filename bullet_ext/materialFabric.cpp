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

/// Mean rest length of the links along edges (m), 0 without any.
double meanEdge(const btSoftBody& body) {
    double sum = 0.0;
    int count = 0;
    for (int l = 0; l < body.m_links.size(); ++l) {
        const btSoftBody::Link& link = body.m_links[l];
        // Until its first step Bullet takes the present lengths for rest lengths.
        const double length =
            body.m_bUpdateRtCst ? (link.m_n[0]->m_x - link.m_n[1]->m_x).length() : link.m_rl;
        if (link.m_bbending || !std::isfinite(length)) continue;
        sum += length;
        ++count;
    }
    return count ? sum / count : 0.0;
}

/// Of a sheet of `density` (N m).
double bendingStiffness(const btSoftBody& body, double density) {
    constexpr double kNone = 2e-5, kPerEdge = 420.0;  // m^4/s^2; 1/s^2
    const double share = std::sqrt(meanStiffness(body, true, 0.0));
    return density * std::max(kNone, kPerEdge * std::pow(meanEdge(body), 4) * share);
}

}  // namespace

Fabric fabricOfMaterials(const btSoftBody& body) {
    constexpr double kSoft = 33.0, kReal = 5000.0, kPoisson = 0.3, kCotton = 0.2, kLightest = 2e-3;
    // Fabrics bend with 1 N m at most. A lighter one of the same stiffness per mass is the same.
    const double bending = bendingStiffness(body, kCotton);
    const double part = std::clamp(1.0 / bending, kLightest / kCotton, 1.0);
    const double young = part * (kSoft + (kReal - kSoft) * meanStiffness(body, false, 1.0));
    Fabric fabric;
    fabric.density = part * kCotton;
    fabric.mu = young / (2.0 * (1.0 + kPoisson));
    fabric.lambda = young * kPoisson / (1.0 - kPoisson * kPoisson);
    fabric.bending = std::min(part * bending, 1.0);
    return fabric;
}

}  // namespace cloth
