#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletCollisionCommon.h>
#include <gtest/gtest.h>

#include <memory>

#include "bullet_ext/shapeSignature.h"

namespace cloth::shape_signature_test {

namespace {

/// A square of 8 x 8 fields without some of them: its box is the same whatever lacks.
struct Floor {
    btTriangleMesh mesh;

    explicit Floor(int hole_begin = 0, int hole_end = 0) {
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 8; ++j) {
                const int field = 8 * i + j;
                if (field >= hole_begin && field < hole_end) continue;
                mesh.addTriangle(at(i, j), at(i, j + 1), at(i + 1, j));
                mesh.addTriangle(at(i + 1, j), at(i, j + 1), at(i + 1, j + 1));
            }
    }
    static btVector3 at(int i, int j) { return {btScalar(i), 0, btScalar(j)}; }
};

btTransform at(const btVector3& place) {
    return btTransform(btQuaternion::getIdentity(), place);
}

}  // namespace

TEST(ShapeSignature, StaysWhileNothingChanges) {
    Floor floor;
    btBvhTriangleMeshShape bvh(&floor.mesh, true);
    btScaledBvhTriangleMeshShape scaled(&bvh, {2, 2, 2});
    btGImpactMeshShape gimpact(&floor.mesh);
    gimpact.updateBound();
    btSphereShape sphere(0.1f);
    btStaticPlaneShape plane({0, 1, 0}, 0);
    btConvexHullShape hull;
    for (int i = 0; i < 8; ++i)
        hull.addPoint({btScalar(i & 1), btScalar(i / 2 % 2), btScalar(i / 4)});
    btEmptyShape empty;
    btCompoundShape compound;
    compound.addChildShape(at({1, 0, 0}), &sphere);
    compound.addChildShape(at({0, 1, 0}), &bvh);
    const btCollisionShape* shapes[] = {&bvh,   &scaled, &gimpact, &sphere,
                                        &plane, &hull,   &empty,   &compound};
    for (const btCollisionShape* shape : shapes) {
        const size_t before = shapeSignature(*shape);
        EXPECT_EQ(shapeSignature(*shape), before) << shape->getName();
        for (const btCollisionShape* other : shapes) {
            if (other == shape) continue;
            EXPECT_NE(shapeSignature(*other), before) << shape->getName() << other->getName();
        }
    }
}

TEST(ShapeSignature, ChangesWithSize) {
    btSphereShape sphere(0.1f);
    const size_t before = shapeSignature(sphere);
    sphere.setUnscaledRadius(0.2f);
    EXPECT_NE(shapeSignature(sphere), before);
}

TEST(ShapeSignature, ChangesWithAPlaceOfAChildWithinTheBox) {
    btSphereShape post(0.1f);
    btBoxShape platform({0.6f, 0.05f, 0.6f});
    btCompoundShape inner, outer;
    inner.addChildShape(at({-4, -1, -4}), &post);
    inner.addChildShape(at({4, 1, 4}), &post);
    inner.addChildShape(at({0, 0, 0}), &platform);
    outer.addChildShape(at({0, 1, 0}), &inner);
    size_t before = shapeSignature(outer);
    inner.updateChildTransform(2, at({2, 0, 0}));
    EXPECT_NE(shapeSignature(outer), before);
    before = shapeSignature(outer);
    inner.updateChildTransform(2, btTransform(btQuaternion({0, 1, 0}, 0.1f), {2, 0, 0}));
    EXPECT_NE(shapeSignature(outer), before);
    before = shapeSignature(outer);
    platform.setImplicitShapeDimensions({0.5f, 0.05f, 0.6f});
    EXPECT_NE(shapeSignature(outer), before);
}

/// Two shapes that are at one address, one after the other, with the same box.
TEST(ShapeSignature, ChangesWithTheTrianglesOfAMeshAtItsAddress) {
    alignas(btBvhTriangleMeshShape) unsigned char place[sizeof(btBvhTriangleMeshShape)];
    const auto of = [&](btStridingMeshInterface& mesh) {
        auto* shape = new (place) btBvhTriangleMeshShape(&mesh, true);
        const size_t signature = shapeSignature(*shape);
        shape->~btBvhTriangleMeshShape();
        return signature;
    };
    Floor whole, open(27, 29), elsewhere(35, 37);
    EXPECT_NE(of(whole.mesh), of(open.mesh));
    EXPECT_NE(of(open.mesh), of(elsewhere.mesh));
    EXPECT_EQ(of(open.mesh), of(open.mesh));
}

TEST(ShapeSignature, ChangesWhereAFewTrianglesHaveOtherCorners) {
    const btScalar first[] = {0, 0, 0, 2, 0, 0, 0, 0, 2, 2, 0, 2, 1, 0, 1};
    btScalar vertices[15];
    std::copy(first, first + 15, vertices);
    int triangles[] = {0, 2, 4, 0, 4, 1, 1, 4, 3, 2, 3, 4};
    btTriangleIndexVertexArray mesh(4, triangles, 3 * sizeof(int), 5, vertices,
                                    3 * sizeof(btScalar));
    const btBvhTriangleMeshShape shape(&mesh, true);
    const size_t before = shapeSignature(shape);
    vertices[12] = 1.5f;
    EXPECT_NE(shapeSignature(shape), before);
    vertices[12] = 1;
    EXPECT_EQ(shapeSignature(shape), before);
    triangles[11] = 0;
    EXPECT_NE(shapeSignature(shape), before);
}

TEST(ShapeSignature, ChangesWithMirroring) {
    Floor floor;
    btTriangleMesh square;
    square.addTriangle({-1, 0, -1}, {-1, 0, 1}, {1, 0, -1});
    square.addTriangle({1, 0, -1}, {-1, 0, 1}, {1, 0, 1});
    btBvhTriangleMeshShape bvh(&square, true);
    btScaledBvhTriangleMeshShape scaled(&bvh, {1, 1, 1});
    const size_t before = shapeSignature(scaled);
    scaled.setLocalScaling({-1, 1, 1});
    EXPECT_NE(shapeSignature(scaled), before);
}

TEST(ShapeSignature, ChangesWithPointsOfAHullWithinItsBox) {
    btVector3 points[] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 1, 1}};
    btConvexHullShape hull(&points[0][0], 5);
    const size_t before = shapeSignature(hull);
    hull.getUnscaledPoints()[4] = {1.5f, 1.5f, 1.5f};
    EXPECT_NE(shapeSignature(hull), before);
}

}  // namespace cloth::shape_signature_test
