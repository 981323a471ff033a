#include "render/drawable.h"

#include <cmath>
#include <limits>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/mesh.h"
#include "render/camera.h"

namespace cloth {

namespace {

using Vec3f = Eigen::Vector3f;

constexpr double kFarthest = 1000.0;  // (m): positions beyond are a failed solver's

bool is_usable(const Points& x, int i) {
    return x.row(i).allFinite() && x.row(i).cwiseAbs().maxCoeff() < kFarthest;
}

void check_faces(const std::string& name, const SceneMesh& mesh) {
    if (!mesh.faces) throw ArgumentError(name, "it has no faces", "set SceneMesh::faces");
    if (mesh.faces->size() == 0) return;
    if (mesh.faces->minCoeff() < 0 || mesh.faces->maxCoeff() >= mesh.vertices.rows())
        throw ArgumentError(name,
                            "a face names a vertex that does not exist (" +
                                std::to_string(mesh.vertices.rows()) + " vertices)",
                            "pass the faces that belong to these vertices");
}

}  // namespace

Vec3f linear(Rgb colour) {
    const Vec3f shown = Vec3f(colour.r, colour.g, colour.b) / 255.0f;
    return shown.cwiseProduct(shown);
}

void check_ground_and_lights(const Scene& scene) {
    check_range("Ground.height", scene.ground.height, -1000.0, 1000.0);
    check_range("Ground.grid", scene.ground.grid, 0.01, 100.0);
    check_range("Ground.radius", scene.ground.radius, 0.1, 1000.0);
    check_range("Lights.key_strength", scene.lights.key_strength, 0.0, 10.0);
    check_range("Lights.fill_strength", scene.lights.fill_strength, 0.0, 10.0);
    check_range("Lights.ambient_sky", scene.lights.ambient_sky, 0.0, 10.0);
    check_range("Lights.ambient_ground", scene.lights.ambient_ground, 0.0, 10.0);
}

Drawable drawable_of(const std::string& name, const SceneMesh& mesh) {
    check_faces(name, mesh);
    check_range(name + ": SceneMesh.gloss", mesh.gloss, 0.0, 1.0);
    check_range(name + ": SceneMesh.depth_offset", mesh.depth_offset, 0.0, 1.0);
    const Points& x = mesh.vertices;
    Faces faces(mesh.faces->rows(), 3);
    Eigen::Index count = 0;
    std::vector<char> usable(static_cast<std::size_t>(x.rows()));
    for (int i = 0; i < x.rows(); ++i) usable[static_cast<std::size_t>(i)] = is_usable(x, i);
    for (Eigen::Index f = 0; f < mesh.faces->rows(); ++f) {
        const auto face = mesh.faces->row(f);
        if (usable[face[0]] && usable[face[1]] && usable[face[2]]) faces.row(count++) = face;
    }
    faces.conservativeResize(count, 3);

    const Points normals = vertex_normals(x, faces);
    Drawable drawable;
    drawable.indices.assign(faces.data(), faces.data() + faces.size());
    drawable.vertices.reserve(static_cast<std::size_t>(6 * x.rows()));
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        for (int k = 0; k < 3; ++k) drawable.vertices.push_back(static_cast<float>(x(i, k)));
        for (int k = 0; k < 3; ++k) drawable.vertices.push_back(static_cast<float>(normals(i, k)));
    }
    return drawable;
}

ShadowView shadow_view(const std::vector<Drawable>& drawables, const Vec3& key, int size) {
    const Vec3 up = std::abs(key.normalized().y()) > 0.99 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    Camera light;
    light.eye = key.normalized();
    light.target = Vec3::Zero();
    light.up = up;
    ShadowView shadow;
    shadow.view = view_matrix(light).cast<float>();
    Vec3f low = Vec3f::Constant(std::numeric_limits<float>::max()), high = -low;
    for (const Drawable& drawable : drawables) {
        for (unsigned i : drawable.indices) {
            const Eigen::Map<const Vec3f> x(&drawable.vertices[6 * i]);
            const Vec3f seen = (shadow.view * x.homogeneous()).head<3>();
            low = low.cwiseMin(seen);
            high = high.cwiseMax(seen);
        }
    }
    if (low.x() > high.x()) return shadow;
    // Room for the filter at the border; square, so that texels are.
    const float half = 0.53f * std::max(high.x() - low.x(), high.y() - low.y()) + 1e-3f;
    const float depth = 0.51f * (high.z() - low.z()) + 1e-3f;
    const Vec3f middle = 0.5f * (low + high);
    shadow.projection.diagonal() << 1 / half, 1 / half, -1 / depth, 1;
    shadow.projection.topRightCorner<3, 1>() << -middle.x() / half, -middle.y() / half,
        middle.z() / depth;
    shadow.texel = 2.0 * half / size;
    return shadow;
}

Eigen::Matrix4f clip_to_texture() {
    Eigen::Matrix4f map = Eigen::Matrix4f::Identity() * 0.5f;
    map.topRightCorner<3, 1>().setConstant(0.5f);
    map(3, 3) = 1.0f;
    return map;
}

Drawable ground_quad(const Ground& ground) {
    Drawable quad;
    for (float x : {-1.0f, 1.0f})
        for (float z : {-1.0f, 1.0f})
            quad.vertices.insert(
                quad.vertices.end(),
                {static_cast<float>(ground.centre.x() + x * ground.radius),
                 static_cast<float>(ground.height),
                 static_cast<float>(ground.centre.z() + z * ground.radius), 0.0f, 1.0f, 0.0f});
    quad.indices = {0, 1, 2, 2, 1, 3};
    return quad;
}

}  // namespace cloth
