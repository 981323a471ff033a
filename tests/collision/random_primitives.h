#pragma once

#include "tests/test_meshes.h"

namespace cloth::test {

/// `count` spheres, capsules and boxes of 2 to 40 cm that move by up to 10 cm and turn by up to 0.7
/// rad, some more than a radian, within half a metre of the origin, and a floor.
inline Boundary random_primitives(std::mt19937& random, int count) {
    const auto pose = [&](const Vec3& place, double angle) {
        return pose_of(place, angle, random_point(random, 1.0).normalized());
    };
    const auto size = [&] { return uniform(random, 0.01, 0.2); };
    Boundary boundary;
    const ObstacleShape shapes[] = {ObstacleShape::sphere, ObstacleShape::capsule,
                                    ObstacleShape::box};
    for (int k = 0; k < count; ++k) {
        Obstacle shape = primitive(shapes[k % 3], {size(), size(), size()}, k % 2 * size());
        if (shape.shape == ObstacleShape::sphere) shape.radius = size();
        const Vec3 place = random_point(random, 0.5);
        shape.pose0 = pose(place, uniform(random, 0.0, 3.0));
        const Pose turn = pose(random_point(random, 0.1 / std::sqrt(3.0)),
                               uniform(random, 0.0, k % 4 == 0 ? 2.0 : 0.7));
        shape.pose1 =
            Pose(Eigen::Translation3d(place) * turn * Eigen::Translation3d(-place)) * shape.pose0;
        boundary.obstacles.push_back(shape);
    }
    Obstacle floor = primitive(ObstacleShape::plane, Vec3::Zero(), 0.0);
    floor.pose0 = floor.pose1 = pose_of({0.0, -0.4, 0.0});
    boundary.obstacles.push_back(floor);
    return boundary;
}

}  // namespace cloth::test
