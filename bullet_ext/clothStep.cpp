#include "bullet_ext/clothStep.h"

#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>

#include "bullet_ext/rigidImpulse.h"

namespace cloth {

bool floatsFreely(const btSoftBody& body, const ClothStep& step) {
    for (int pin : step.garment.pins())
        if (!(body.m_nodes[pin].m_im > 0)) return false;
    for (int a = 0; a < body.m_anchors.size(); ++a)
        if (!isDynamic(*body.m_anchors[a].m_body)) return false;
    return std::all_of(step.near.begin(), step.near.end(),
                       [](const NearSolid& solid) { return solid.body != nullptr; });
}

bool allSolidsKnown(const ClothStep& step) {
    size_t parts = 0;
    for (const NearSolid& solid : step.near) parts += solid.parts->size();
    return parts == step.boundary.obstacles.size();
}

bool obstaclesStand(const Boundary& boundary) {
    return std::all_of(
        boundary.obstacles.begin(), boundary.obstacles.end(), [](const Obstacle& obstacle) {
            return obstacle.pose0.matrix() == obstacle.pose1.matrix() && obstacle.x0 == obstacle.x1;
        });
}

}  // namespace cloth
