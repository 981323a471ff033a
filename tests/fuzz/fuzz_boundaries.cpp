#include "tests/fuzz/fuzz_boundaries.h"

#include <limits>

#include "tests/test_meshes.h"

namespace cloth::test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Vec3 vector(Random& random, double half_width) {
    const double x = random.uniform(-half_width, half_width);
    const double y = random.uniform(-half_width, half_width);
    return {x, y, random.uniform(-half_width, half_width)};
}

Points noise(Random& random, Eigen::Index rows, double half_width) {
    Points points(rows, 3);
    for (Eigen::Index i = 0; i < rows; ++i) points.row(i) = vector(random, half_width);
    return points;
}

/// Makes one number of a few hundred bad.
void spoil_rarely(Points& points, Random& random) {
    if (points.rows() == 0 || !random.chance(0.04)) return;
    points(static_cast<Eigen::Index>(random.below(static_cast<size_t>(points.rows()))),
           random.between(0, 2)) = random.one_of<double>({nan, infinity, -infinity, 1e308, 1e20});
}

double random_size(Random& random) {
    if (random.chance(0.8)) return random.uniform(0.02, 0.2);
    return random.one_of<double>({0.0, 1e-9, 1e6, -0.1, nan, infinity, 1e300});
}

Pose random_pose(Random& random, const Vec3& near_by) {
    const Vec3 axis = vector(random, 1.0) + Vec3(0.0, 1e-3, 0.0);
    return test::pose_of(near_by + vector(random, 0.2), random.uniform(0.0, 6.0), axis);
}

void move(Obstacle& obstacle, Random& random) {
    const double distance = random.one_of<double>({0.0, 0.0, 0.01, 0.3, 1e3});
    const Vec3 shift = vector(random, distance);
    obstacle.pose1.translation() += shift;
    obstacle.x1.rowwise() += shift.transpose();
    if (random.chance(0.2)) obstacle.pose1.linear() = obstacle.pose1.linear().transpose().eval();
    if (random.chance(0.02)) obstacle.pose1.linear().setZero();
    if (random.chance(0.02)) obstacle.pose0.translation()[1] = nan;
}

void spoil_mesh(Obstacle& mesh, Random& random) {
    Faces faces = *mesh.faces;
    switch (random.between(0, 9)) {
        case 0:
            faces(0, 1) = random.one_of<int>({-1, 100000, 2147483647});
            break;
        case 1:
            faces.resize(0, 3);
            break;
        case 2:
            faces.col(0).swap(faces.col(1));
            break;  // inside out
        case 3:
            mesh.x0 += noise(random, mesh.x0.rows(), 0.1);
            break;  // crosses itself
        case 4:
            mesh.x1.conservativeResize(mesh.x1.rows() - 1, 3);
            break;
        case 5:
            mesh.x0.conservativeResize(3, 3), mesh.x1.conservativeResize(3, 3);
            break;
        case 6:
            mesh.x1.setConstant(0.1);
            break;  // to a point
        case 7:
            mesh.x0.col(1).setZero(), mesh.x1.col(1).setZero();
            break;  // flat
        case 8:
            mesh.faces.reset();
            return;
        default:
            mesh.x0 *= 1e-9, mesh.x1 *= 1e-9;
            break;
    }
    mesh.faces = std::make_shared<const Faces>(faces);
}

Obstacle random_mesh_obstacle(Random& random, const Vec3& near_by) {
    TriMesh mesh = random.chance(0.5) ? test::icosphere(random.between(0, 2)) : test::cube();
    if (random.chance(0.2)) mesh = test::triangle_soup(mesh);
    mesh.vertices *= random.uniform(0.02, 0.2);
    mesh.vertices = transformed(mesh.vertices, random_pose(random, near_by));
    return test::mesh_obstacle(mesh);
}

Obstacle random_obstacle(Random& random, const Vec3& near_by) {
    Obstacle obstacle;
    if (random.chance(0.4)) {
        obstacle = random_mesh_obstacle(random, near_by);
        move(obstacle, random);
        if (random.chance(0.3)) spoil_mesh(obstacle, random);
        spoil_rarely(obstacle.x0, random);
        spoil_rarely(obstacle.x1, random);
    } else {
        const auto shape =
            random.one_of<ObstacleShape>({ObstacleShape::sphere, ObstacleShape::capsule,
                                          ObstacleShape::box, ObstacleShape::plane});
        const Vec3 half(random_size(random), random_size(random), random_size(random));
        obstacle = test::primitive(shape, half, random_size(random));
        obstacle.pose0 = obstacle.pose1 = random_pose(random, near_by);
        move(obstacle, random);
    }
    if (random.chance(0.2)) obstacle.friction = random.one_of<double>({0.0, 1.5, -1.0, 1e9, nan});
    return obstacle;
}

void add_pin_targets(const Garment& garment, Random& random, Boundary& boundary) {
    const std::vector<int>& pins = garment.pins();
    boundary.pin_targets.resize(static_cast<Eigen::Index>(pins.size()), 3);
    for (size_t k = 0; k < pins.size(); ++k)
        boundary.pin_targets.row(static_cast<Eigen::Index>(k)) =
            garment.rest().vertices.row(pins[k]);
    const double distance = random.one_of<double>({0.0, 0.0, 0.02, 1.0, 1e3, 1e12});
    boundary.pin_targets += noise(random, boundary.pin_targets.rows(), distance);
    spoil_rarely(boundary.pin_targets, random);
    if (random.chance(0.03)) boundary.pin_targets.conservativeResize(random.between(0, 9), 3);
}

}  // namespace

Boundary random_boundary(const Garment& garment, Random& random) {
    Boundary boundary;
    const Vec3 middle = garment.rest().vertices.colwise().mean();
    for (int count = random.one_of<int>({0, 1, 1, 2, 3}); count > 0; --count)
        boundary.obstacles.push_back(random_obstacle(random, middle));
    if (!boundary.obstacles.empty() && random.chance(0.1))
        boundary.obstacles.push_back(boundary.obstacles.front());
    add_pin_targets(garment, random, boundary);
    if (random.chance(0.1))
        boundary.gravity = Vec3(0, random.one_of<double>({0.0, 1e3, 1e30, 1e200, nan}), 0);
    if (random.chance(0.2)) {
        boundary.accelerations = noise(random, garment.vertex_count(), random.magnitude(1.0, 1e6));
        spoil_rarely(boundary.accelerations, random);
        if (random.chance(0.1)) boundary.accelerations.conservativeResize(3, 3);
    }
    return boundary;
}

ClothState random_state(const Garment& garment, Random& random) {
    ClothState state = ClothState::at_rest(garment);
    const double crumpled = random.one_of<double>({0.0, 0.0, 0.01, 0.5, 1e6});
    state.x += noise(random, state.x.rows(), crumpled);
    state.v += noise(random, state.x.rows(), random.one_of<double>({0.0, 1.0, 1e3, 1e9}));
    if (random.chance(0.03)) state.x.setConstant(0.1);
    if (random.chance(0.03)) state.x.array() += random.one_of<double>({1e3, 1e12, 1e160, 1e307});
    spoil_rarely(state.x, random);
    spoil_rarely(state.v, random);
    if (random.chance(0.02)) state.x.conservativeResize(random.between(0, 5), 3);
    if (random.chance(0.02)) state.v.conservativeResize(random.between(0, 5), 3);
    if (random.chance(0.05)) state.time = nan;
    return state;
}

double random_time_step(Random& random) {
    if (random.chance(0.7)) return 1.0 / 30.0;
    return random.one_of<double>(
        {1.0 / 240.0, 1e-9, 10.0, 0.0, -0.1, nan, infinity, 1e-300, 1e300});
}

}  // namespace cloth::test
