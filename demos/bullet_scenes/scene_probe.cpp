#include "demos/bullet_scenes/scene_probe.h"

#include <algorithm>
#include <cmath>

#include "bullet_ext/softBodyGarment.h"
#include "demos/hard_cases/pictures.h"

namespace cloth {

namespace {

bool isNear(const btVector3& x) {
    constexpr btScalar kFar = 1000;  // m
    return std::isfinite(x.length()) && x.length() < kFar;
}

bool isNear(const btSoftBody& body) {
    for (int i = 0; i < body.m_nodes.size(); ++i)
        if (!isNear(body.m_nodes[i].m_x)) return false;
    return true;
}

bool mayTouch(const btSoftBody& cloth, const btCollisionObject& body) {
    const auto& disabled = cloth.m_collisionDisabledObjects;
    return disabled.findLinearSearch(&body) == disabled.size();
}

/// A soft body without faces as crossed ribbons along its links.
TriMesh ribbons(const btSoftBody& body) {
    constexpr double kHalf = 8e-3;  // m
    TriMesh mesh{Points(8 * body.m_links.size(), 3), Faces(4 * body.m_links.size(), 3)};
    for (int l = 0; l < body.m_links.size(); ++l) {
        const Vec3 a = toVec3(body.m_links[l].m_n[0]->m_x), b = toVec3(body.m_links[l].m_n[1]->m_x);
        const Vec3 along = (b - a).stableNormalized();
        const Vec3 side = along.unitOrthogonal(), other = along.cross(side);
        int v = 8 * l, f = 4 * l;
        for (const Vec3& across : {side, other}) {
            mesh.vertices.row(v) = a - kHalf * across;
            mesh.vertices.row(v + 1) = a + kHalf * across;
            mesh.vertices.row(v + 2) = b - kHalf * across;
            mesh.vertices.row(v + 3) = b + kHalf * across;
            mesh.faces.row(f++) << v, v + 1, v + 2;
            mesh.faces.row(f++) << v + 1, v + 3, v + 2;
            v += 4;
        }
    }
    return mesh;
}

TriMesh surfaceOf(const ShapePart& part, const Pose& pose) {
    Obstacle obstacle;
    obstacle.shape = part.shape;
    obstacle.half_extents = part.half_extents;
    obstacle.radius = part.radius;
    obstacle.pose1 = pose * part.frame;
    obstacle.faces = part.faces;
    obstacle.x1 = transformed(part.vertices, pose);
    return surface_of(obstacle);
}

}  // namespace

SceneProbe::Solid& SceneProbe::solidOf(const btCollisionObject& body) {
    Solid& solid = m_solids[&body];
    if (solid.parts.empty()) {
        solid.parts = partsOfShape(*body.getCollisionShape());
        for (const ShapePart& part : solid.parts) solid.distances.emplace_back(part);
    }
    return solid;
}

bool SceneProbe::finite() const {
    for (const btSoftBody* body : m_scene.cloth())
        if (!isNear(*body)) return false;
    for (const btSoftBody* body : m_scene.others())
        if (!isNear(*body)) return false;
    return std::all_of(m_scene.rigid().begin(), m_scene.rigid().end(), [](const auto& body) {
        return isNear(body->getWorldTransform().getOrigin());
    });
}

double SceneProbe::deepest() {
    constexpr double kReach = 0.2;  // m
    double depth = 0.0;
    for (const btCollisionObject* body : m_scene.solids()) {
        const Solid& solid = solidOf(*body);
        const Pose inverse = toPose(body->getWorldTransform()).inverse();
        for (const btSoftBody* cloth : m_scene.cloth())
            for (int i = 0; mayTouch(*cloth, *body) && i < cloth->m_nodes.size(); ++i) {
                if (!(cloth->m_nodes[i].m_im > 0)) continue;
                const Vec3 local = inverse * toVec3(cloth->m_nodes[i].m_x);
                for (const PartDistance& part : solid.distances)
                    if (const auto distance = part.at(local, kReach))
                        depth = std::max(depth, -*distance);
            }
    }
    return depth;
}

std::vector<double> SceneProbe::stretches() const {
    std::vector<double> all;
    for (const btSoftBody* cloth : m_scene.cloth())
        for (int l = 0; l < cloth->m_links.size(); ++l) {
            const btSoftBody::Link& link = cloth->m_links[l];
            if (link.m_bbending || !(link.m_rl > 0)) continue;
            all.push_back(static_cast<double>(link.m_n[0]->m_x.distance(link.m_n[1]->m_x)) /
                          static_cast<double>(link.m_rl));
        }
    return all;
}

double SceneProbe::fastestNode() const {
    btScalar fastest = 0;
    for (const auto* bodies : {&m_scene.cloth(), &m_scene.others()})
        for (const btSoftBody* body : *bodies)
            for (int i = 0; i < body->m_nodes.size(); ++i)
                fastest = std::max(fastest, body->m_nodes[i].m_v.length());
    return static_cast<double>(fastest);
}

double SceneProbe::fastestBody() const {
    btScalar fastest = 0;
    for (const auto& body : m_scene.rigid())
        fastest = std::max(fastest, body->getLinearVelocity().length());
    return static_cast<double>(fastest);
}

Vec3 SceneProbe::momentum() const {
    Vec3 sum = Vec3::Zero();
    for (const btSoftBody* cloth : m_scene.cloth())
        for (int i = 0; i < cloth->m_nodes.size(); ++i)
            if (cloth->m_nodes[i].m_im > 0)
                sum += toVec3(cloth->m_nodes[i].m_v) / static_cast<double>(cloth->m_nodes[i].m_im);
    for (const auto& body : m_scene.rigid())
        if (body->getInvMass() > 0)
            sum += toVec3(body->getLinearVelocity()) / static_cast<double>(body->getInvMass());
    return sum;
}

std::vector<Points> SceneProbe::cloth() const {
    std::vector<Points> all;
    for (const btSoftBody* body : m_scene.cloth()) all.push_back(nodePositions(*body));
    return all;
}

std::vector<Points> SceneProbe::others() const {
    std::vector<Points> all;
    for (const btSoftBody* body : m_scene.others()) all.push_back(nodePositions(*body));
    return all;
}

ScenePicture SceneProbe::picture() {
    ScenePicture picture;
    for (const btCollisionObject* body : m_scene.solids()) {
        const Pose pose = toPose(body->getWorldTransform());
        for (const ShapePart& part : solidOf(*body).parts)
            if (part.shape != ObstacleShape::plane) picture.rigid.push_back(surfaceOf(part, pose));
    }
    for (const btSoftBody* body : m_scene.cloth())
        picture.cloth.push_back({nodePositions(*body), faceNodes(*body)});
    for (const btSoftBody* body : m_scene.others())
        picture.others.push_back(body->m_faces.size()
                                     ? TriMesh{nodePositions(*body), faceNodes(*body)}
                                     : ribbons(*body));
    return picture;
}

}  // namespace cloth
