#include "bullet_ext/bulletShapes.h"

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <LinearMath/btConvexHullComputer.h>
#include <btBulletCollisionCommon.h>

#include <array>
#include <cmath>
#include <map>

#include "data/core/mesh.h"
#include "data/core/pose.h"

namespace cloth {

namespace {

constexpr int kSegments = 48;         ///< around a cylinder or cone: 0.2 % of the radius off
constexpr btScalar kWorldSize = 1e4;  ///< concave shapes are read within this box (m)

ShapePart meshPart(Points vertices, Faces faces) {
    ShapePart part;
    part.faces = std::make_shared<const Faces>(std::move(faces));
    part.vertices = std::move(vertices);
    return part;
}

/// Rotation that takes y to the axis 0 (x), 1 (y) or 2 (z).
Pose axisFrame(int axis) {
    Pose frame = Pose::Identity();
    if (axis == 0) frame.rotate(Eigen::AngleAxisd(-M_PI / 2, Vec3::UnitZ()));
    if (axis == 2) frame.rotate(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitX()));
    return frame;
}

/// Bullet does not promise on which side its polygons are counter-clockwise.
void turnOutward(const Points& vertices, Faces& faces) {
    const Points areas = face_area_vectors(vertices, faces);
    const Eigen::RowVector3d centre = vertices.colwise().mean();
    double volume = 0.0;
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        volume += areas.row(f).dot(vertices.row(faces(f, 0)) - centre);
    if (volume < 0.0) faces.col(1).swap(faces.col(2));
}

ShapePart hullPart(const std::vector<btVector3>& points) {
    Points rows(static_cast<Eigen::Index>(points.size()), 3);
    for (size_t i = 0; i < points.size(); ++i)
        rows.row(static_cast<Eigen::Index>(i)) = toVec3(points[i]);
    TriMesh hull = convexHull(rows);
    return meshPart(std::move(hull.vertices), std::move(hull.faces));
}

/// A body of revolution about the axis: the rings (height, radius) joined from bottom to top.
ShapePart revolvedPart(const std::vector<std::array<double, 2>>& rings, int axis) {
    std::vector<btVector3> points;
    const Pose frame = axisFrame(axis);
    for (const auto& [height, radius] : rings)
        for (int s = 0; s < (radius > 0.0 ? kSegments : 1); ++s) {
            const double angle = 2.0 * M_PI * s / kSegments;
            points.push_back(toBullet(
                Vec3(frame * Vec3(radius * std::cos(angle), height, radius * std::sin(angle)))));
        }
    return hullPart(points);
}

/// Support points of any convex shape in evenly spread directions (a spiral). The margin of a round
/// shape is part of its surface; that of a polyhedron is Bullet's safety zone and is left out.
ShapePart sampledConvexPart(const btConvexShape& shape) {
    constexpr int kDirections = 642;
    std::vector<btVector3> points;
    for (int i = 0; i < kDirections; ++i) {
        const double y = 1.0 - (2.0 * i + 1.0) / kDirections;
        const double r = std::sqrt(1.0 - y * y), angle = i * M_PI * (3.0 - std::sqrt(5.0));
        const btVector3 direction = toBullet(Vec3(r * std::cos(angle), y, r * std::sin(angle)));
        points.push_back(shape.isPolyhedral()
                             ? shape.localGetSupportingVertexWithoutMargin(direction)
                             : shape.localGetSupportingVertex(direction));
    }
    return hullPart(points);
}

ShapePart hullOfConvexHullShape(const btConvexHullShape& shape) {
    std::vector<btVector3> points;
    for (int i = 0; i < shape.getNumPoints(); ++i) points.push_back(shape.getScaledPoint(i));
    return points.size() < 4 ? ShapePart{} : hullPart(points);
}

/// Gathers the triangles of a concave shape and welds corners with the same coordinates.
struct TriangleCollector : btTriangleCallback {
    std::map<std::array<float, 3>, int> corners;
    std::vector<Vec3> vertices;
    std::vector<std::array<int, 3>> triangles;

    int corner(const btVector3& p) {
        const auto [it, inserted] = corners.try_emplace({p.x(), p.y(), p.z()}, vertices.size());
        if (inserted) vertices.push_back(toVec3(p));
        return it->second;
    }
    void processTriangle(btVector3* triangle, int, int) override {
        const std::array<int, 3> t = {corner(triangle[0]), corner(triangle[1]),
                                      corner(triangle[2])};
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
    }
};

bool mirrors(const btVector3& scaling) {
    return ((scaling.x() < 0) != (scaling.y() < 0)) != (scaling.z() < 0);
}

/// Whether triangles are clockwise where the user's mesh is counter-clockwise: Bullet scales their
/// corners, and leaves their order.
bool isMirrored(const btConcaveShape& shape) {
    const bool mirrored = mirrors(shape.getLocalScaling());
    if (shape.getShapeType() != SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE) return mirrored;
    const auto& scaled = static_cast<const btScaledBvhTriangleMeshShape&>(shape);
    return mirrored != mirrors(scaled.getChildShape()->getLocalScaling());
}

/// Bullet's triangles of a heightfield face up along y, and down along x and z.
bool facesDown(const btHeightfieldTerrainShape& shape, const Points& vertices, const Faces& faces) {
    return face_area_vectors(vertices, faces).col(shape.getUpAxis()).sum() < 0.0;
}

ShapePart concavePart(const btConcaveShape& shape) {
    TriangleCollector collector;
    const btVector3 reach(kWorldSize, kWorldSize, kWorldSize);
    shape.processAllTriangles(&collector, -reach, reach);
    Points vertices(static_cast<Eigen::Index>(collector.vertices.size()), 3);
    for (size_t i = 0; i < collector.vertices.size(); ++i)
        vertices.row(static_cast<Eigen::Index>(i)) = collector.vertices[i];
    Faces faces(static_cast<Eigen::Index>(collector.triangles.size()), 3);
    for (size_t f = 0; f < collector.triangles.size(); ++f)
        for (int c = 0; c < 3; ++c)
            faces(static_cast<Eigen::Index>(f), c) = collector.triangles[f][static_cast<size_t>(c)];
    const bool inside_out =
        shape.getShapeType() == TERRAIN_SHAPE_PROXYTYPE
            ? facesDown(static_cast<const btHeightfieldTerrainShape&>(shape), vertices, faces)
            : isMirrored(shape);
    if (inside_out) faces.col(1).swap(faces.col(2));
    return meshPart(std::move(vertices), std::move(faces));
}

ShapePart planePart(const btStaticPlaneShape& shape) {
    ShapePart part;
    part.shape = ObstacleShape::plane;
    const Vec3 normal = toVec3(shape.getPlaneNormal()).normalized();
    part.frame.linear() = rotation_between(Vec3::UnitY(), normal).toRotationMatrix();
    part.frame.translation() = normal * static_cast<double>(shape.getPlaneConstant());
    return part;
}

ShapePart spherePart(const btSphereShape& shape) {
    ShapePart part;
    part.shape = ObstacleShape::sphere;
    part.radius = shape.getRadius();
    return part;
}

ShapePart boxPart(const btBoxShape& shape) {
    ShapePart part;
    part.shape = ObstacleShape::box;
    part.half_extents = toVec3(shape.getHalfExtentsWithMargin());
    return part;
}

ShapePart capsulePart(const btCapsuleShape& shape) {
    ShapePart part;
    part.shape = ObstacleShape::capsule;
    part.radius = shape.getRadius();
    part.half_extents = Vec3(0, shape.getHalfHeight(), 0);
    part.frame = axisFrame(shape.getUpAxis());
    return part;
}

ShapePart cylinderPart(const btCylinderShape& shape) {
    const int axis = shape.getUpAxis();
    const double height = shape.getHalfExtentsWithMargin()[axis], radius = shape.getRadius();
    return revolvedPart({{-height, radius}, {height, radius}}, axis);
}

ShapePart conePart(const btConeShape& shape) {
    const double half = 0.5 * static_cast<double>(shape.getHeight());
    return revolvedPart({{-half, shape.getRadius()}, {half, 0.0}}, shape.getConeUpIndex());
}

std::vector<ShapePart> partsOfCompound(const btCompoundShape& compound) {
    std::vector<ShapePart> parts;
    for (int i = 0; i < compound.getNumChildShapes(); ++i) {
        const Pose child = toPose(compound.getChildTransform(i));
        for (ShapePart& part : partsOfShape(*compound.getChildShape(i))) {
            part.frame = child * part.frame;
            part.vertices = transformed(part.vertices, child);
            parts.push_back(std::move(part));
        }
    }
    return parts;
}

bool isEmpty(const ShapePart& part) {
    return part.shape == ObstacleShape::mesh && (!part.faces || part.faces->rows() == 0);
}

ShapePart partOfShape(const btCollisionShape& shape) {
    switch (shape.getShapeType()) {
        case SPHERE_SHAPE_PROXYTYPE:
            return spherePart(static_cast<const btSphereShape&>(shape));
        case BOX_SHAPE_PROXYTYPE:
            return boxPart(static_cast<const btBoxShape&>(shape));
        case CAPSULE_SHAPE_PROXYTYPE:
            return capsulePart(static_cast<const btCapsuleShape&>(shape));
        case STATIC_PLANE_PROXYTYPE:
            return planePart(static_cast<const btStaticPlaneShape&>(shape));
        case CYLINDER_SHAPE_PROXYTYPE:
            return cylinderPart(static_cast<const btCylinderShape&>(shape));
        case CONE_SHAPE_PROXYTYPE:
            return conePart(static_cast<const btConeShape&>(shape));
        case CONVEX_HULL_SHAPE_PROXYTYPE:
            return hullOfConvexHullShape(static_cast<const btConvexHullShape&>(shape));
        default:
            break;
    }
    if (shape.isConvex()) return sampledConvexPart(static_cast<const btConvexShape&>(shape));
    if (shape.isConcave()) return concavePart(static_cast<const btConcaveShape&>(shape));
    return {};
}

}  // namespace

TriMesh convexHull(const Points& points) {
    if (points.rows() < 4) return {};
    btConvexHullComputer hull;
    hull.compute(points.data(), 3 * sizeof(double), static_cast<int>(points.rows()), 0, 0);
    Points vertices(hull.vertices.size(), 3);
    for (int i = 0; i < hull.vertices.size(); ++i) vertices.row(i) = toVec3(hull.vertices[i]);
    std::vector<std::array<int, 3>> triangles;
    for (int f = 0; f < hull.faces.size(); ++f) {
        const btConvexHullComputer::Edge* first = &hull.edges[hull.faces[f]];
        const int apex = first->getSourceVertex();
        for (const auto* edge = first->getNextEdgeOfFace(); edge->getTargetVertex() != apex;
             edge = edge->getNextEdgeOfFace())
            triangles.push_back({apex, edge->getSourceVertex(), edge->getTargetVertex()});
    }
    Faces faces(static_cast<Eigen::Index>(triangles.size()), 3);
    for (size_t f = 0; f < triangles.size(); ++f)
        faces.row(static_cast<Eigen::Index>(f)) << triangles[f][0], triangles[f][1],
            triangles[f][2];
    turnOutward(vertices, faces);
    return {std::move(vertices), std::move(faces)};
}

std::vector<ShapePart> partsOfShape(const btCollisionShape& shape) {
    if (shape.getShapeType() == COMPOUND_SHAPE_PROXYTYPE)
        return partsOfCompound(static_cast<const btCompoundShape&>(shape));
    // Empty and soft body shapes count as concave in Bullet but have no triangles to give.
    if (shape.getShapeType() == EMPTY_SHAPE_PROXYTYPE || shape.isSoftBody()) return {};
    std::vector<ShapePart> parts = {partOfShape(shape)};
    if (isEmpty(parts.front())) parts.clear();
    return parts;
}

}  // namespace cloth
