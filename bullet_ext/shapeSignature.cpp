#include "bullet_ext/shapeSignature.h"

#include <BulletCollision/CollisionShapes/btConvexTriangleMeshShape.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace cloth {

namespace {

class SignatureHash {
 public:
    void add(std::uint64_t bits) { m_value = (m_value ^ bits) * 1099511628211ull; }
    void addAddress(const void* address) { add(reinterpret_cast<std::uintptr_t>(address)); }
    void addBytes(const void* data, size_t count) {
        const auto* bytes = static_cast<const unsigned char*>(data);
        for (size_t i = 0; i < count; i += sizeof(std::uint64_t)) {
            std::uint64_t bits = 0;
            std::memcpy(&bits, bytes + i, std::min(sizeof bits, count - i));
            add(bits);
        }
    }
    /// Without the fourth number, which Bullet leaves as it is.
    void add(const btVector3& v) { addBytes(&v[0], 3 * sizeof(btScalar)); }
    /// Evenly spread ones of `count` elements of `size` bytes that lie `stride` bytes apart.
    void addSamples(const unsigned char* base, int count, int stride, size_t size) {
        constexpr int kSamples = 16;
        if (!base || count <= 0) return;
        const int samples = std::min(count, kSamples);
        for (int k = 0; k < samples; ++k) {
            const std::int64_t i =
                samples > 1 ? static_cast<std::int64_t>(k) * (count - 1) / (samples - 1) : 0;
            addBytes(base + i * stride, size);
        }
    }
    size_t value() const { return static_cast<size_t>(m_value); }

 private:
    std::uint64_t m_value = 14695981039346656037ull;
};

size_t bytesOf(PHY_ScalarType type) {
    switch (type) {
        case PHY_DOUBLE:
            return 8;
        case PHY_SHORT:
            return 2;
        case PHY_UCHAR:
            return 1;
        default:
            return 4;
    }
}

/// Null: the shape has none.
const btStridingMeshInterface* trianglesOf(const btCollisionShape& shape) {
    switch (shape.getShapeType()) {
        case TRIANGLE_MESH_SHAPE_PROXYTYPE:
        case MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE:
            return static_cast<const btTriangleMeshShape&>(shape).getMeshInterface();
        case CONVEX_TRIANGLEMESH_SHAPE_PROXYTYPE:
            return static_cast<const btConvexTriangleMeshShape&>(shape).getMeshInterface();
        case GIMPACT_SHAPE_PROXYTYPE: {
            const auto& gimpact = static_cast<const btGImpactShapeInterface&>(shape);
            if (gimpact.getGImpactShapeType() == CONST_GIMPACT_TRIMESH_SHAPE)
                return static_cast<const btGImpactMeshShape&>(shape).getMeshInterface();
            return nullptr;
        }
        default:
            return nullptr;
    }
}

void addTriangles(const btStridingMeshInterface& mesh, SignatureHash& hash) {
    hash.addAddress(&mesh);
    for (int part = 0; part < mesh.getNumSubParts(); ++part) {
        const unsigned char *vertices = nullptr, *triangles = nullptr;
        int vertex_count = 0, vertex_stride = 0, triangle_count = 0, triangle_stride = 0;
        PHY_ScalarType vertex_type = PHY_FLOAT, index_type = PHY_INTEGER;
        mesh.getLockedReadOnlyVertexIndexBase(&vertices, vertex_count, vertex_type, vertex_stride,
                                              &triangles, triangle_stride, triangle_count,
                                              index_type, part);
        hash.addAddress(vertices);
        hash.addAddress(triangles);
        for (const int number : {vertex_count, triangle_count})
            hash.add(static_cast<std::uint64_t>(number));
        hash.addSamples(vertices, vertex_count, vertex_stride, 3 * bytesOf(vertex_type));
        hash.addSamples(triangles, triangle_count, triangle_stride, 3 * bytesOf(index_type));
        mesh.unLockReadOnlyVertexBase(part);
    }
}

void addShape(const btCollisionShape& shape, SignatureHash& hash);

void addChildren(const btCompoundShape& compound, SignatureHash& hash) {
    // Children that are moved do not change the compound's own revision.
    hash.add(static_cast<std::uint64_t>(compound.getUpdateRevision()));
    for (int i = 0; i < compound.getNumChildShapes(); ++i) {
        const btTransform& place = compound.getChildTransform(i);
        hash.add(place.getOrigin());
        for (int r = 0; r < 3; ++r) hash.add(place.getBasis()[r]);
        addShape(*compound.getChildShape(i), hash);
    }
}

void addShape(const btCollisionShape& shape, SignatureHash& hash) {
    hash.addAddress(&shape);
    hash.add(static_cast<std::uint64_t>(shape.getShapeType()));
    btVector3 low, high;
    shape.getAabb(btTransform::getIdentity(), low, high);
    hash.add(low);
    hash.add(high);
    hash.add(shape.getLocalScaling());
    const btScalar margin = shape.getMargin();
    hash.addBytes(&margin, sizeof margin);
    if (shape.isCompound()) addChildren(static_cast<const btCompoundShape&>(shape), hash);
    if (shape.getShapeType() == SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE)
        addShape(*static_cast<const btScaledBvhTriangleMeshShape&>(shape).getChildShape(), hash);
    if (shape.getShapeType() == CONVEX_HULL_SHAPE_PROXYTYPE) {
        const auto& hull = static_cast<const btConvexHullShape&>(shape);
        hash.add(static_cast<std::uint64_t>(hull.getNumPoints()));
        hash.addSamples(reinterpret_cast<const unsigned char*>(hull.getUnscaledPoints()),
                        hull.getNumPoints(), sizeof(btVector3), 3 * sizeof(btScalar));
    }
    if (const btStridingMeshInterface* triangles = trianglesOf(shape))
        addTriangles(*triangles, hash);
}

}  // namespace

size_t shapeSignature(const btCollisionShape& shape) {
    SignatureHash hash;
    addShape(shape, hash);
    return hash.value();
}

}  // namespace cloth
