#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletCollisionCommon.h>
#include <gtest/gtest.h>

#include <cmath>

#include "bullet_ext/bulletShapes.h"
#include "data/core/mesh.h"

namespace cloth::bullet_shapes_test {

namespace {

/// Volume of a closed mesh (m^3), positive if its faces are counter-clockwise from outside.
double volume(const ShapePart& part) {
    double sum = 0.0;
    for (Eigen::Index f = 0; f < part.faces->rows(); ++f) {
        const Vec3 a = part.vertices.row((*part.faces)(f, 0));
        const Vec3 b = part.vertices.row((*part.faces)(f, 1));
        const Vec3 c = part.vertices.row((*part.faces)(f, 2));
        sum += a.dot(b.cross(c)) / 6.0;
    }
    return sum;
}

ShapePart only_part(const btCollisionShape& shape) {
    std::vector<ShapePart> parts = partsOfShape(shape);
    EXPECT_EQ(parts.size(), 1u);
    return parts.empty() ? ShapePart{} : parts.front();
}

void expect_closed_mesh(const ShapePart& part) {
    ASSERT_EQ(part.shape, ObstacleShape::mesh);
    EXPECT_NO_THROW(validate_mesh("part", {part.vertices, *part.faces}));
    const auto edges = static_cast<Eigen::Index>(undirected_edges(*part.faces).size());
    EXPECT_EQ(part.vertices.rows() - edges + part.faces->rows(), 2);  // Euler: a sphere
}

/// A tetrahedron, faces counter-clockwise from outside.
struct Tetrahedron {
    btTriangleMesh mesh;
    Tetrahedron() {
        const btVector3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), d(0, 0, 1);
        mesh.addTriangle(a, c, b);
        mesh.addTriangle(a, b, d);
        mesh.addTriangle(a, d, c);
        mesh.addTriangle(b, c, d);
    }
};

}  // namespace

TEST(BulletShapes, PrimitivesStayPrimitives) {
    EXPECT_NEAR(only_part(btSphereShape(0.3f)).radius, 0.3, 1e-6);
    const ShapePart box = only_part(btBoxShape({0.1f, 0.2f, 0.3f}));
    EXPECT_EQ(box.shape, ObstacleShape::box);
    EXPECT_NEAR((box.half_extents - Vec3(0.1, 0.2, 0.3)).norm(), 0.0, 1e-6);
    const ShapePart plane = only_part(btStaticPlaneShape({0, 0, 1}, 0.5f));
    EXPECT_EQ(plane.shape, ObstacleShape::plane);
    EXPECT_NEAR((plane.frame * Vec3(0, 0, 0) - Vec3(0, 0, 0.5)).norm(), 0.0, 1e-6);
    EXPECT_NEAR((plane.frame.linear() * Vec3::UnitY() - Vec3::UnitZ()).norm(), 0.0, 1e-6);
}

TEST(BulletShapes, CapsulesOfAllAxesPointAlongThem) {
    const btCapsuleShapeX x(0.1f, 1);
    const btCapsuleShape y(0.1f, 1);
    const btCapsuleShapeZ z(0.1f, 1);
    const btCollisionShape* shapes[] = {&x, &y, &z};
    for (int axis = 0; axis < 3; ++axis) {
        const ShapePart part = only_part(*shapes[axis]);
        EXPECT_EQ(part.shape, ObstacleShape::capsule);
        EXPECT_NEAR(part.radius, 0.1, 1e-6);
        EXPECT_NEAR(part.half_extents.y(), 0.5, 1e-6);
        EXPECT_NEAR(std::abs((part.frame.linear() * Vec3::UnitY())[axis]), 1.0, 1e-6);
    }
}

TEST(BulletShapes, CylinderAndConeHaveTheirVolume) {
    const ShapePart cylinder = only_part(btCylinderShapeZ({0.2f, 0.2f, 0.5f}));
    expect_closed_mesh(cylinder);
    EXPECT_NEAR(volume(cylinder), M_PI * 0.04 * 1.0, 0.005 * 0.126);
    EXPECT_NEAR(cylinder.vertices.col(2).maxCoeff(), 0.5, 1e-6);
    const ShapePart cone = only_part(btConeShapeX(0.3f, 0.9f));
    expect_closed_mesh(cone);
    EXPECT_NEAR(volume(cone), M_PI * 0.09 * 0.9 / 3.0, 0.005 * 0.0848);
    EXPECT_NEAR(cone.vertices.col(0).maxCoeff(), 0.45, 1e-6);
}

TEST(BulletShapes, ConvexHullIsItsPointsWithoutMargin) {
    btConvexHullShape hull;
    for (int i = 0; i < 8; ++i)
        hull.addPoint({i & 1 ? 1.0f : 0.0f, i & 2 ? 1.0f : 0.0f, i & 4 ? 1.0f : 0.0f});
    hull.addPoint({0.5f, 0.5f, 0.5f});
    hull.setMargin(0.04f);
    const ShapePart part = only_part(hull);
    expect_closed_mesh(part);
    EXPECT_EQ(part.vertices.rows(), 8);
    EXPECT_NEAR(volume(part), 1.0, 1e-5);
    hull.setLocalScaling({2, 1, 1});
    EXPECT_NEAR(volume(only_part(hull)), 2.0, 1e-5);
}

TEST(BulletShapes, AnyOtherConvexShapeIsSampled) {
    const btVector3 centres[] = {{0, 0, 0}, {1, 0, 0}};
    const btScalar radii[] = {0.5f, 0.5f};
    const btMultiSphereShape capsule(centres, radii, 2);
    const ShapePart part = only_part(capsule);
    expect_closed_mesh(part);
    const double exact = M_PI * 0.25 * 1.0 + 4.0 / 3.0 * M_PI * 0.125;
    EXPECT_NEAR(volume(part), exact, 0.03 * exact);
}

TEST(BulletShapes, TriangleMeshesKeepTheirTrianglesAndScale) {
    Tetrahedron tetrahedron;
    btBvhTriangleMeshShape bvh(&tetrahedron.mesh, true);
    const ShapePart part = only_part(bvh);
    expect_closed_mesh(part);
    EXPECT_EQ(part.vertices.rows(), 4);
    EXPECT_NEAR(volume(part), 1.0 / 6.0, 1e-6);
    btScaledBvhTriangleMeshShape scaled(&bvh, {2, 2, 2});
    EXPECT_NEAR(volume(only_part(scaled)), 8.0 / 6.0, 1e-5);
    btGImpactMeshShape gimpact(&tetrahedron.mesh);
    gimpact.updateBound();
    EXPECT_NEAR(volume(only_part(gimpact)), 1.0 / 6.0, 1e-6);
}

TEST(BulletShapes, MirroredTriangleMeshesFaceOutward) {
    Tetrahedron tetrahedron;
    for (const btVector3& scaling : {btVector3(-1, 1, 1),
                                     {1, 1, -2},
                                     {0.5f, -1, 1},
                                     {-1, -2, -1},
                                     {-1, 1, -1},
                                     {0.5f, 1, -0.5f}}) {
        const double exact = std::abs(scaling.x() * scaling.y() * scaling.z()) / 6.0;
        btBvhTriangleMeshShape bvh(&tetrahedron.mesh, true);
        const btScaledBvhTriangleMeshShape scaled(&bvh, scaling);
        EXPECT_NEAR(volume(only_part(scaled)), exact, 1e-5);
        btGImpactMeshShape gimpact(&tetrahedron.mesh);
        gimpact.setLocalScaling(scaling);
        gimpact.updateBound();
        EXPECT_NEAR(volume(only_part(gimpact)), exact, 1e-5);
        bvh.setLocalScaling(scaling);
        EXPECT_NEAR(volume(only_part(bvh)), exact, 1e-5);
        const btScaledBvhTriangleMeshShape twice(&bvh, {-1, 1, 1});
        EXPECT_NEAR(volume(only_part(twice)), exact, 1e-5);
        bvh.setLocalScaling({1, 1, 1});
    }
}

TEST(BulletShapes, HeightfieldFacesUp) {
    const float heights[9] = {0, 0, 0, 0, 0.5f, 0, 0, 0, 0};
    for (const int up : {0, 1, 2})
        for (const bool flip : {false, true}) {
            btHeightfieldTerrainShape terrain(3, 3, heights, 1.0f, 0.0f, 0.5f, up, PHY_FLOAT, flip);
            const ShapePart part = only_part(terrain);
            ASSERT_EQ(part.faces->rows(), 8);
            const Points normals = face_normals(part.vertices, *part.faces);
            EXPECT_GT(normals.col(up).minCoeff(), 0.0) << up << " " << flip;
        }
}

TEST(BulletShapes, CompoundIsItsChildrenInPlace) {
    btSphereShape sphere(0.1f);
    btConvexHullShape hull;
    for (int i = 0; i < 8; ++i)
        hull.addPoint({i & 1 ? 1.0f : 0.0f, i & 2 ? 1.0f : 0.0f, i & 4 ? 1.0f : 0.0f});
    btCompoundShape inner, outer;
    inner.addChildShape(btTransform(btQuaternion::getIdentity(), {0, 1, 0}), &sphere);
    const btQuaternion quarter({0, 0, 1}, SIMD_HALF_PI);
    outer.addChildShape(btTransform(quarter, {1, 0, 0}), &inner);
    outer.addChildShape(btTransform(quarter, {0, 0, 0}), &hull);
    const std::vector<ShapePart> parts = partsOfShape(outer);
    ASSERT_EQ(parts.size(), 2u);
    EXPECT_NEAR((parts[0].frame.translation() - Vec3(0, 0, 0)).norm(), 0.0, 1e-6);
    EXPECT_NEAR(parts[1].vertices.col(0).minCoeff(), -1.0, 1e-6);
    EXPECT_NEAR(volume(parts[1]), 1.0, 1e-5);
}

TEST(BulletShapes, EmptyShapesHaveNoParts) {
    EXPECT_TRUE(partsOfShape(btEmptyShape()).empty());
    EXPECT_TRUE(partsOfShape(btCompoundShape()).empty());
    EXPECT_TRUE(partsOfShape(btConvexHullShape()).empty());
}

}  // namespace cloth::bullet_shapes_test
