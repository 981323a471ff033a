// Looks at pictures: what is where it projects, in front of what it hides, lit as it should be.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "data/core/errors.h"
#include "render/osmesa_renderer.h"
#include "tests/render/temporary_folder.h"

namespace cloth::test {
namespace {

constexpr int kSize = 200;
const Rgb kRed = {220, 60, 50};
const Rgb kGreen = {60, 190, 70};

/// Square sheet of `side` metres in the plane z = `z` around (x, y), front towards +z.
SceneMesh sheet(double side, double x, double y, double z, Rgb colour) {
    constexpr int kCells = 12, kPoints = kCells + 1;
    SceneMesh mesh;
    mesh.vertices.resize(kPoints * kPoints, 3);
    Faces faces(2 * kCells * kCells, 3);
    for (int i = 0; i < kPoints * kPoints; ++i)
        mesh.vertices.row(i) << x + side * (double(i % kPoints) / kCells - 0.5),
            y + side * (double(i / kPoints) / kCells - 0.5), z;
    for (int cell = 0; cell < kCells * kCells; ++cell) {
        const int a = cell / kCells * kPoints + cell % kCells, c = a + kPoints;
        faces.row(2 * cell) << a, a + 1, c;
        faces.row(2 * cell + 1) << a + 1, c + 1, c;
    }
    mesh.faces = std::make_shared<const Faces>(faces);
    mesh.colour = colour;
    mesh.back_colour = back_of(colour);
    mesh.two_sided = true;
    return mesh;
}

/// Ball around (x, y, z), of rings and segments.
SceneMesh ball(double radius, double x, double y, double z, Rgb colour) {
    constexpr int kRings = 16, kSegments = 32;
    const double pi = std::acos(-1.0);
    SceneMesh mesh;
    mesh.vertices.resize((kRings + 1) * kSegments, 3);
    Faces faces(2 * kRings * kSegments, 3);
    for (int ring = 0; ring <= kRings; ++ring) {
        for (int k = 0; k < kSegments; ++k) {
            // Not quite to the poles, where triangles would have no area.
            const double theta = pi * (0.001 + 0.998 * ring / kRings), phi = 2 * pi * k / kSegments;
            mesh.vertices.row(ring * kSegments + k) << x + radius * std::sin(theta) * std::sin(phi),
                y + radius * std::cos(theta), z + radius * std::sin(theta) * std::cos(phi);
        }
    }
    for (int ring = 0; ring < kRings; ++ring) {
        for (int k = 0; k < kSegments; ++k) {
            const int a = ring * kSegments + k, b = ring * kSegments + (k + 1) % kSegments;
            faces.row(2 * (ring * kSegments + k)) << a, a + kSegments, b;
            faces.row(2 * (ring * kSegments + k) + 1) << b, a + kSegments, b + kSegments;
        }
    }
    mesh.faces = std::make_shared<const Faces>(faces);
    mesh.colour = colour;
    return mesh;
}

Scene scene_of(std::vector<SceneMesh> meshes) {
    Scene scene;
    scene.meshes = std::move(meshes);
    scene.ground.visible = false;
    return scene;
}

/// Looks along -z at the origin from `z` metres.
Camera camera_at(double z) {
    Camera camera;
    camera.eye = Vec3(0, 0, z);
    camera.target = Vec3::Zero();
    return camera;
}

class Picture : public ::testing::Test {
 protected:
    static void SetUpTestSuite() {
        OsmesaSettings settings;
        settings.width = settings.height = kSize;
        settings.shadow_size = 256;
        renderer = std::make_unique<OsmesaRenderer>(settings);
    }
    static void TearDownTestSuite() { renderer.reset(); }

    static std::unique_ptr<OsmesaRenderer> renderer;
};

std::unique_ptr<OsmesaRenderer> Picture::renderer;

bool is_red(Rgb c) {
    return c.r > 1.6 * c.g && c.r > 1.6 * c.b && c.r > 40;
}
bool is_green(Rgb c) {
    return c.g > 1.4 * c.r && c.g > 1.4 * c.b && c.g > 40;
}
double brightness(Rgb c) {
    return (c.r + c.g + c.b) / 3.0;
}

Rgb pixel_of(const Image& image, const Camera& camera, const Vec3& point) {
    const PixelPosition p = project(camera, point, image.width(), image.height());
    return image.at(static_cast<int>(p.x), static_cast<int>(p.y));
}

bool same_bytes(const Image& a, const Image& b) {
    return std::equal(a.bytes(), a.bytes() + 3 * a.width() * a.height(), b.bytes());
}

TEST_F(Picture, ClothIsExactlyWhereItProjects) {
    Camera camera = camera_at(3.0);
    camera.eye += Vec3(0.7, 0.4, 0.0);
    const double side = 0.8, x = 0.1, y = -0.15;
    const Image image = renderer->render(scene_of({sheet(side, x, y, 0, kRed)}), camera);
    const Image empty = renderer->render(scene_of({}), camera);
    int inside = 0, outside = 0;
    for (double dy = -1.0; dy <= 1.0; dy += 0.02) {
        for (double dx = -1.0; dx <= 1.0; dx += 0.02) {
            const PixelPosition p = project(camera, Vec3(x + dx, y + dy, 0), kSize, kSize);
            if (p.x < 0 || p.y < 0 || p.x >= kSize || p.y >= kSize) continue;
            const int column = static_cast<int>(p.x), row = static_cast<int>(p.y);
            const double reach = std::max(std::abs(dx), std::abs(dy));
            if (reach < 0.5 * side - 0.02) {
                EXPECT_TRUE(is_red(image.at(column, row))) << dx << ", " << dy;
                ++inside;
            } else if (reach > 0.5 * side + 0.02) {
                EXPECT_EQ(image.at(column, row), empty.at(column, row)) << dx << ", " << dy;
                ++outside;
            }
        }
    }
    EXPECT_GT(inside, 1000);
    EXPECT_GT(outside, 1000);
}

TEST_F(Picture, BothSidesOfClothAreSeenInTheirOwnColour) {
    SceneMesh cloth = sheet(1.0, 0, 0, 0, kRed);
    cloth.back_colour = kGreen;
    const Scene scene = scene_of({cloth});
    EXPECT_TRUE(
        is_red(pixel_of(renderer->render(scene, camera_at(3)), camera_at(3), Vec3(0, 0, 0))));
    EXPECT_TRUE(
        is_green(pixel_of(renderer->render(scene, camera_at(-3)), camera_at(-3), Vec3(0, 0, 0))));
}

TEST_F(Picture, OneSidedSurfacesAreNotSeenFromBehind) {
    SceneMesh skin = sheet(1.0, 0, 0, 0, kRed);
    skin.two_sided = false;
    const Scene scene = scene_of({skin});
    EXPECT_TRUE(is_red(renderer->render(scene, camera_at(3)).at(kSize / 2, kSize / 2)));
    EXPECT_EQ(renderer->render(scene, camera_at(-3)).at(kSize / 2, kSize / 2), scene.background);
}

TEST_F(Picture, WhatIsInFrontHidesWhatIsBehindInAnyOrder) {
    const SceneMesh cloth = sheet(1.2, 0, 0, 0, kRed);
    const SceneMesh body = ball(0.25, 0, 0, 0.5, kGreen);
    for (const Scene& scene : {scene_of({cloth, body}), scene_of({body, cloth})}) {
        const Image front = renderer->render(scene, camera_at(3));
        EXPECT_TRUE(is_green(front.at(kSize / 2, kSize / 2)));
        EXPECT_TRUE(is_red(pixel_of(front, camera_at(3), Vec3(0.5, 0.5, 0))));
        EXPECT_TRUE(is_red(renderer->render(scene, camera_at(-3)).at(kSize / 2, kSize / 2)));
    }
}

TEST_F(Picture, ClothFourMillimetresOffTheBodyDoesNotFlicker) {
    SceneMesh body = ball(0.400, 0, 0, 0, kGreen);
    SceneMesh cloth = ball(0.404, 0, 0, 0, kRed);
    cloth.two_sided = true;
    body.depth_offset = 0.002;
    const Camera camera = camera_at(4.0);
    const Image image = renderer->render(scene_of({body, cloth}), camera);
    int green = 0, red = 0;
    for (int i = 0; i < kSize * kSize; ++i) {
        green += is_green(image.at(i % kSize, i / kSize));
        red += is_red(image.at(i % kSize, i / kSize));
    }
    EXPECT_EQ(green, 0) << "the body shines through";
    EXPECT_GT(red, 3000);
}

TEST_F(Picture, DepthOffsetChangesTheDepthOnly) {
    SceneMesh back = ball(0.3, 0, 0, 0, kGreen);
    const Image plain = renderer->render(scene_of({back}), camera_at(3));
    back.depth_offset = 0.01;
    EXPECT_TRUE(same_bytes(renderer->render(scene_of({back}), camera_at(3)), plain));
    const SceneMesh patch = sheet(0.1, 0, 0, 0.295, kRed);
    EXPECT_TRUE(
        is_red(renderer->render(scene_of({back, patch}), camera_at(3)).at(kSize / 2, kSize / 2)));
}

TEST_F(Picture, ShadingOfABallIsSmooth) {
    Scene scene = scene_of({ball(0.5, 0, 0, 0, kRed)});
    scene.lights.shadows = false;
    const Camera camera = camera_at(3);
    const Image image = renderer->render(scene, camera);
    int largest = 0;
    for (double x = -0.4; x < 0.4; x += 0.01) {
        const PixelPosition p = project(camera, Vec3(x, 0.1, 0.5), kSize, kSize);
        const Rgb a = image.at(static_cast<int>(p.x), static_cast<int>(p.y));
        const Rgb b = image.at(static_cast<int>(p.x) + 1, static_cast<int>(p.y));
        largest = std::max(largest, std::abs(a.r - b.r));
    }
    // Flat faces, 32 around the ball, would jump by the tenth part of the whole range.
    EXPECT_LE(largest, 8);
}

TEST_F(Picture, SideTowardsTheKeyLightIsBrighter) {
    Scene scene = scene_of({ball(0.5, 0, 0, 0, {200, 200, 200})});
    const Camera camera = camera_at(3);
    for (const Vec3& key : {Vec3(1, 0, 0.3), Vec3(-1, 0, 0.3)}) {
        scene.lights.key = key;
        const Image image = renderer->render(scene, camera);
        const double right = brightness(pixel_of(image, camera, Vec3(0.35, 0, 0.35)));
        const double left = brightness(pixel_of(image, camera, Vec3(-0.35, 0, 0.35)));
        EXPECT_GT((right - left) * key.x(), 30.0);
    }
}

/// A horizontal sheet above (x, 0).
SceneMesh roof(double side, double x, double height) {
    SceneMesh mesh = sheet(side, 0, 0, 0, kRed);
    mesh.vertices.col(2) = -mesh.vertices.col(1);
    mesh.vertices.col(1).setConstant(height);
    mesh.vertices.col(0).array() += x;
    return mesh;
}

TEST_F(Picture, ClothThrowsItsShadowAndNothingElseDoes) {
    Scene scene = scene_of({roof(0.4, -0.5, 0.8), roof(0.4, 0.5, 0.8)});
    scene.ground.visible = true;
    scene.ground.grid = 100.0;
    scene.lights.key = Vec3(0, 1, 0.001);
    Camera camera = camera_at(4);
    camera.eye.y() = 1.0;
    const Image image = renderer->render(scene, camera);
    scene.lights.shadows = false;
    const Image unshaded = renderer->render(scene, camera);
    for (double x : {-0.5, 0.5}) {
        const Vec3 below(x, 0, 0.1);
        EXPECT_LT(brightness(pixel_of(image, camera, below)),
                  0.85 * brightness(pixel_of(unshaded, camera, below)));
    }
    for (const Vec3& lit : {Vec3(0, 0, 0.1), Vec3(0.9, 0, 0.1), Vec3(0.5, 0.8, 0)})
        EXPECT_EQ(pixel_of(image, camera, lit), pixel_of(unshaded, camera, lit)) << lit.x();
}

TEST_F(Picture, FloorFadesIntoTheBackground) {
    Scene scene = scene_of({});
    scene.ground.visible = true;
    scene.ground.radius = 3.0;
    scene.ground.grid = 100.0;
    Camera camera = camera_at(4);
    camera.eye.y() = 2.0;
    const Image image = renderer->render(scene, camera);
    const auto difference = [&](const Vec3& point) {
        return std::abs(brightness(pixel_of(image, camera, point)) - brightness(scene.background));
    };
    EXPECT_GT(difference(Vec3(0.3, 0, 0.3)), 20.0);
    EXPECT_LE(difference(Vec3(0, 0, -2.95)), 2.0);
    EXPECT_EQ(image.at(kSize / 2, 2), scene.background);
}

TEST_F(Picture, FacesOfAFailedSolverAreLeftOutAndTheRestIsDrawn) {
    SceneMesh cloth = sheet(1.0, 0, 0, 0, kRed);
    cloth.vertices(0, 1) = std::numeric_limits<double>::quiet_NaN();
    cloth.vertices(12, 0) = std::numeric_limits<double>::infinity();
    cloth.vertices(156, 2) = 1e30;
    const Image image = renderer->render(scene_of({cloth}), camera_at(3));
    EXPECT_TRUE(is_red(image.at(kSize / 2, kSize / 2)));

    SceneMesh rest = sheet(1.0, 0, 0, 0, kRed);
    Faces faces(0, 3);
    for (int f = 0; f < rest.faces->rows(); ++f) {
        const Eigen::RowVector3i face = rest.faces->row(f);
        const auto touches = [&](int vertex) { return (face.array() == vertex).any(); };
        if (touches(0) || touches(12) || touches(156)) continue;
        faces.conservativeResize(faces.rows() + 1, 3);
        faces.bottomRows<1>() = face;
    }
    EXPECT_LT(faces.rows(), rest.faces->rows());
    rest.faces = std::make_shared<const Faces>(faces);
    EXPECT_TRUE(same_bytes(image, renderer->render(scene_of({rest}), camera_at(3))));

    cloth.vertices.setConstant(std::numeric_limits<double>::quiet_NaN());
    EXPECT_TRUE(same_bytes(renderer->render(scene_of({cloth}), camera_at(3)),
                           renderer->render(scene_of({}), camera_at(3))));
}

TEST_F(Picture, LabelsChangeTheirCornerOnly) {
    Scene scene = scene_of({sheet(1.0, 0, 0, 0, kRed)});
    const Image plain = renderer->render(scene, camera_at(3));
    scene.labels = {{"fast+2\n12 ms", LabelCorner::top_left, 20, {255, 255, 255}, {255, 255, 0}}};
    const Image labelled = renderer->render(scene, camera_at(3));
    int white = 0, yellow = 0;
    for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
            white += labelled.at(x, y) == Rgb{255, 255, 255};
            yellow += labelled.at(x, y) == Rgb{255, 255, 0};
            if (x > 3 * kSize / 4 || y > kSize / 2) {
                EXPECT_EQ(labelled.at(x, y), plain.at(x, y));
            }
        }
    }
    EXPECT_GT(white, 20);
    EXPECT_GT(yellow, 20);
}

TEST_F(Picture, EqualScenesGiveEqualPictures) {
    Scene scene = scene_of({ball(0.3, 0, 0.3, 0, kGreen), sheet(0.9, 0, 0, 0.2, kRed)});
    scene.ground.visible = true;
    scene.labels = {{"reference"}};
    Camera camera = camera_at(3);
    camera.eye.y() = 1.0;
    const Image first = renderer->render(scene, camera);
    renderer->render(scene_of({}), camera_at(2));
    EXPECT_TRUE(same_bytes(renderer->render(scene, camera), first));
    OsmesaSettings settings;
    settings.width = settings.height = kSize;
    settings.shadow_size = 256;
    EXPECT_TRUE(same_bytes(OsmesaRenderer(settings).render(scene, camera), first))
        << "another renderer";
    EXPECT_TRUE(same_bytes(renderer->render(scene, camera), first)) << "after another renderer";
}

TEST_F(Picture, AntiAliasingSoftensEdges) {
    OsmesaSettings settings;
    settings.width = settings.height = kSize;
    settings.anti_aliasing = false;
    Scene scene = scene_of({ball(0.5, 0, 0, 0, kRed)});
    scene.lights.shadows = false;
    const auto mixed = [&](const Image& image) {
        int count = 0;
        for (int i = 0; i < kSize * kSize; ++i) {
            const Rgb c = image.at(i % kSize, i / kSize);
            count += c != scene.background && !is_red(c);
        }
        return count;
    };
    EXPECT_EQ(mixed(OsmesaRenderer(settings).render(scene, camera_at(3))), 0);
    EXPECT_GT(mixed(renderer->render(scene, camera_at(3))), 50);
}

TEST_F(Picture, TrackedFigureIsWhollyInThePicture) {
    FigureTracker tracker(FramingSettings{}, 1.0);
    for (int frame = 0; frame < 20; ++frame) {
        const SceneMesh figure = ball(0.8, 0.2 * frame, 1, 0.1 * frame, kRed);
        const Image image = renderer->render(scene_of({figure}), tracker.follow(figure.vertices));
        int red = 0, at_border = 0;
        for (int i = 0; i < kSize * kSize; ++i) {
            const int x = i % kSize, y = i / kSize;
            const bool border = std::min({x, y, kSize - 1 - x, kSize - 1 - y}) < kSize / 20;
            red += is_red(image.at(x, y));
            at_border += border && is_red(image.at(x, y));
        }
        EXPECT_EQ(at_border, 0) << "frame " << frame;
        EXPECT_GT(red, kSize * kSize / 5) << "frame " << frame;
    }
}

TEST_F(Picture, UnusableScenesAreRefusedByName) {
    SceneMesh cloth = sheet(1.0, 0, 0, 0, kRed);
    cloth.vertices.conservativeResize(5, 3);
    const std::string message = message_of<ArgumentError>([&] {
        renderer->render(scene_of({ball(1, 0, 0, 0, kRed), cloth}), camera_at(3));
    });
    EXPECT_NE(message.find("meshes[1]"), std::string::npos) << message;
    EXPECT_THROW(renderer->render(scene_of({SceneMesh()}), camera_at(3)), ArgumentError);
    EXPECT_THROW(renderer->render(scene_of({}), camera_at(0)), ArgumentError);
    OsmesaSettings settings;
    settings.width = 5;
    EXPECT_THROW(OsmesaRenderer{settings}, ArgumentError);
}

}  // namespace
}  // namespace cloth::test
