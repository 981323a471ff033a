#pragma once

#include <optional>

#include "data/core/mesh.h"
#include "render/camera.h"

namespace cloth {

/// A half-line, as from the eye through a pixel.
struct Ray {
    Vec3 from;  ///< (m)
    Vec3 way;   ///< of unit length
};

/// The ray that ends in the picture at (x, y), pixels from the top left corner.
Ray ray_through(const Camera& camera, double x, double y, int width, int height);

/// How far along the ray it first meets the mesh (m), and the corner of that face that is nearest
/// to where; nothing: it passes by.
struct RayHit {
    double distance;
    int vertex;
};
std::optional<RayHit> first_hit(const Ray& ray, const Points& vertices, const Faces& faces);

/// The vertex of the cloth that the ray shows; nothing where there is no cloth, or where the body
/// is before it.
std::optional<int> shown_vertex(const Ray& ray, const Points& cloth, const Faces& cloth_faces,
                                const Points& body, const Faces& body_faces);

/// Where the ray meets the plane through `point` that faces the camera; `point` itself where it is
/// not before the eye.
Vec3 on_picture_plane(const Ray& ray, const Camera& camera, const Vec3& point);

}  // namespace cloth
