#include "demos/viewer/pick.h"

#include <gtest/gtest.h>

#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::viewer_pick_test {

namespace {

Camera camera_from_above() {
    Camera camera;
    camera.eye = Vec3(0.3, 2.0, 1.0);
    camera.target = Vec3(0.1, 0.0, 0.1);
    return camera;
}

/// A level square of two faces at a height (m).
TriMesh square(double height) {
    TriMesh mesh;
    mesh.vertices.resize(4, 3);
    mesh.vertices << -1, height, -1, -1, height, 1, 1, height, 1, 1, height, -1;
    mesh.faces.resize(2, 3);
    mesh.faces << 0, 1, 2, 0, 2, 3;
    return mesh;
}

}  // namespace

TEST(ViewerPick, ARayShowsThePointThatIsDrawnThere) {
    const Camera camera = camera_from_above();
    for (const Vec3& point : {Vec3(0.0, 0.0, 0.0), Vec3(0.4, 0.3, -0.2), Vec3(-0.5, -0.1, 0.4)}) {
        const PixelPosition pixel = project(camera, point, 640, 400);
        const Ray ray = ray_through(camera, pixel.x, pixel.y, 640, 400);
        EXPECT_NEAR(ray.way.norm(), 1.0, 1e-12);
        EXPECT_NEAR((point - ray.from).cross(ray.way).norm(), 0.0, 1e-9);
        EXPECT_NEAR((on_picture_plane(ray, camera, point) - point).norm(), 0.0, 1e-9);
    }
}

TEST(ViewerPick, TheNearestVertexOfTheFirstFaceIsTaken) {
    const TriMesh sheet = cloth::test::sheet(12, 0.5);
    const Camera camera = camera_from_above();
    for (const int vertex : {20, 60, 77}) {
        const Vec3 place = sheet.vertices.row(vertex).transpose();
        const PixelPosition pixel = project(camera, place, 640, 400);
        const Ray ray = ray_through(camera, pixel.x + 0.3, pixel.y - 0.2, 640, 400);
        const auto hit = first_hit(ray, sheet.vertices, sheet.faces);
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->vertex, vertex);
        EXPECT_NEAR(hit->distance, (place - ray.from).norm(), 5e-3);
    }
}

TEST(ViewerPick, ARayBackwardsOrBesideMeetsNothing) {
    const TriMesh floor = square(0.0);
    EXPECT_TRUE(first_hit({Vec3(0, 1, 0), Vec3(0, -1, 0)}, floor.vertices, floor.faces));
    EXPECT_FALSE(first_hit({Vec3(0, 1, 0), Vec3(0, 1, 0)}, floor.vertices, floor.faces));
    EXPECT_FALSE(first_hit({Vec3(3, 1, 0), Vec3(0, -1, 0)}, floor.vertices, floor.faces));
}

TEST(ViewerPick, ClothBehindTheBodyIsNotTaken) {
    const TriMesh cloth = square(0.0), above = square(0.5), below = square(-0.5);
    const Ray ray{Vec3(0.9, 2, 0.8), Vec3(0, -1, 0)};
    const auto taken = [&](const TriMesh& body) {
        return shown_vertex(ray, cloth.vertices, cloth.faces, body.vertices, body.faces);
    };
    EXPECT_EQ(taken(below).value_or(-1), 2);
    EXPECT_FALSE(taken(above));
}

TEST(ViewerPick, AHandStaysInThePlaneOfItsGrip) {
    const Camera camera = camera_from_above();
    const Vec3 grip(0.2, 0.1, -0.3), forward = (camera.target - camera.eye).normalized();
    for (const double x : {10.0, 300.0, 620.0}) {
        const Vec3 hand = on_picture_plane(ray_through(camera, x, 50, 640, 400), camera, grip);
        EXPECT_NEAR((hand - grip).dot(forward), 0.0, 1e-9);
    }
    const Vec3 behind = camera.eye - forward;
    EXPECT_EQ(on_picture_plane(ray_through(camera, 10, 50, 640, 400), camera, behind), behind);
}

}  // namespace cloth::viewer_pick_test
