#include "bullet_ext/bodyFollower.h"

#include <limits>

namespace cloth {

Boundary obstaclesAround(const btSoftBody& body, const std::vector<const Points*>& x,
                         BulletObstacles& obstacles, double h) {
    constexpr double kReach = 0.05;  // m: a fine vertex is not farther from the nodes around it
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Vec3 low = Vec3::Constant(kInfinity), high = Vec3::Constant(-kInfinity);
    for (const Points* const points : x) {
        if (points->rows() == 0) continue;
        low = low.cwiseMin(points->colwise().minCoeff().transpose());
        high = high.cwiseMax(points->colwise().maxCoeff().transpose());
    }
    low.array() -= kReach;
    high.array() += kReach;
    obstacles.watch(body, low, high);
    Boundary boundary;
    boundary.obstacles = obstacles.near(body, low, high, {h, 0.0});
    boundary.trees = obstacles.trees();
    return boundary;
}

}  // namespace cloth
