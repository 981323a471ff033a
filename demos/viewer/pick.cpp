#include "demos/viewer/pick.h"

#include <cmath>

#include "data/core/triangle.h"

namespace cloth {

Ray ray_through(const Camera& camera, double x, double y, int width, int height) {
    const Eigen::Matrix4d view = view_matrix(camera);
    const double tangent = std::tan(camera.fov_y_deg * M_PI / 360.0);
    const double scale = 2.0 * tangent / height;
    const Vec3 seen((x - 0.5 * width) * scale, (0.5 * height - y) * scale, -1.0);
    return {camera.eye, (view.topLeftCorner<3, 3>().transpose() * seen).normalized()};
}

std::optional<RayHit> first_hit(const Ray& ray, const Points& vertices, const Faces& faces) {
    std::optional<RayHit> nearest;
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const Vec3 a = vertices.row(faces(f, 0)), b = vertices.row(faces(f, 1)),
                   c = vertices.row(faces(f, 2));
        const auto hit = meet_line(ray.from, ray.way, a, b, c);
        if (!hit || !hit->is_inside() || hit->at <= 0.0) continue;
        if (nearest && hit->at >= nearest->distance) continue;
        const Vec3 weight(1.0 - hit->u - hit->v, hit->u, hit->v);
        const Vec3 place = weight[0] * a + weight[1] * b + weight[2] * c;
        Eigen::Index corner;
        Vec3((a - place).squaredNorm(), (b - place).squaredNorm(), (c - place).squaredNorm())
            .minCoeff(&corner);
        nearest = RayHit{hit->at, faces(f, corner)};
    }
    return nearest;
}

std::optional<int> shown_vertex(const Ray& ray, const Points& cloth, const Faces& cloth_faces,
                                const Points& body, const Faces& body_faces) {
    const auto hit = first_hit(ray, cloth, cloth_faces);
    if (!hit) return std::nullopt;
    const auto before = first_hit(ray, body, body_faces);
    if (before && before->distance < hit->distance) return std::nullopt;
    return hit->vertex;
}

Vec3 on_picture_plane(const Ray& ray, const Camera& camera, const Vec3& point) {
    const Vec3 forward = (camera.target - camera.eye).normalized();
    const double depth = (point - camera.eye).dot(forward), along = ray.way.dot(forward);
    if (depth <= 0.0 || along <= 0.0) return point;
    return ray.from + depth / along * ray.way;
}

}  // namespace cloth
