#include "bullet_ext/bodyFollower.h"

namespace cloth {

void showFollower(const btSoftBody& body, const Points& x, const std::vector<LimbSet>& ignored,
                  BulletObstacles& obstacles, double h, Follower& follower) {
    if (x.rows() == 0 || !x.allFinite()) return;
    constexpr double kReach = 0.05;  // m: a fine vertex is not farther from the nodes around it
    const Vec3 margin = Vec3::Constant(kReach);
    const Vec3 low = x.colwise().minCoeff().transpose() - margin;
    const Vec3 high = x.colwise().maxCoeff().transpose() + margin;
    obstacles.watch(body, low, high);
    Boundary boundary;
    boundary.obstacles = obstacles.near(body, low, high, {h, 0.0});
    boundary.trees = obstacles.trees();
    follower.show(x, boundary, ignored);
}

}  // namespace cloth
