#include "demos/hard_cases/props.h"

#include <algorithm>
#include <cmath>

#include "data/authoring/sheet.h"

namespace cloth {

namespace {
constexpr double sheet_size = 0.6;  // (m)
}

double ramp(double time, double begin, double end) {
    return std::clamp((time - begin) / (end - begin), 0.0, 1.0);
}

double eased(double time, double begin, double end) {
    const double s = ramp(time, begin, end);
    return s * s * (3.0 - 2.0 * s);
}

Obstacle ball(double radius, const Vec3& centre0, const Vec3& centre1) {
    Obstacle sphere;
    sphere.shape = ObstacleShape::sphere;
    sphere.radius = radius;
    sphere.pose0 = placed(centre0);
    sphere.pose1 = placed(centre1);
    return sphere;
}

Obstacle capsule(double radius, double half, const Pose& pose0, const Pose& pose1) {
    Obstacle limb;
    limb.shape = ObstacleShape::capsule;
    limb.radius = radius;
    limb.half_extents = Vec3(0.0, half, 0.0);
    limb.pose0 = pose0;
    limb.pose1 = pose1;
    return limb;
}

Obstacle box(const Vec3& half_extents, const Vec3& centre0, const Vec3& centre1) {
    Obstacle block;
    block.shape = ObstacleShape::box;
    block.half_extents = half_extents;
    block.pose0 = placed(centre0);
    block.pose1 = placed(centre1);
    return block;
}

Pose placed(const Vec3& position) {
    Pose pose = Pose::Identity();
    pose.translation() = position;
    return pose;
}

Pose turned_about_x(const Vec3& position, double angle) {
    Pose pose = placed(position);
    pose.linear() = Eigen::AngleAxisd(angle, Vec3::UnitX()).toRotationMatrix();
    return pose;
}

TriMesh level_sheet(int vertices) {
    return make_sheet(sheet_size, sheet_size, vertices);
}

TriMesh hanging_sheet(int vertices) {
    TriMesh sheet = level_sheet(vertices);
    sheet.vertices.col(1) = -sheet.vertices.col(2);
    sheet.vertices.col(2).setZero();
    return sheet;
}

std::vector<int> clipped(const TriMesh& mesh, const std::vector<Vec3>& points, double reach) {
    std::vector<int> pins;
    for (int v = 0; v < mesh.vertices.rows(); ++v)
        for (const Vec3& point : points)
            if ((mesh.vertices.row(v).transpose() - point).norm() < reach) pins.push_back(v);
    std::sort(pins.begin(), pins.end());
    pins.erase(std::unique(pins.begin(), pins.end()), pins.end());
    return pins;
}

std::vector<int> top_seam(const TriMesh& mesh) {
    const double top = mesh.vertices.col(1).maxCoeff();
    std::vector<int> pins;
    for (int v = 0; v < mesh.vertices.rows(); ++v)
        if (mesh.vertices(v, 1) > top - 1e-9) pins.push_back(v);
    return pins;
}

}  // namespace cloth
