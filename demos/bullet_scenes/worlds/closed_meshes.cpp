#include "closed_meshes.h"

#include <cmath>

#include "demo_world.h"

namespace {

btSoftBody* bodyOf(btSoftBodyWorldInfo& info, const std::vector<btScalar>& vertices,
                   const std::vector<int>& faces) {
    btSoftBody* body = btSoftBodyHelpers::CreateFromTriMesh(info, vertices.data(), faces.data(),
                                                            static_cast<int>(faces.size() / 3),
                                                            /*randomizeConstraints=*/false);
    shuffleLinks(body);
    return body;
}

}  // namespace

btSoftBody* createBall(btSoftBodyWorldInfo& info, const btVector3& centre, btScalar radius, int n) {
    const btScalar golden_angle = SIMD_PI * (3 - std::sqrt(btScalar(5)));
    std::vector<btVector3> points;
    for (int i = 0; i < n; ++i) {
        const btScalar y = 1 - (2 * static_cast<btScalar>(i) + 1) / static_cast<btScalar>(n);
        const btScalar r = std::sqrt(1 - y * y), angle = golden_angle * static_cast<btScalar>(i);
        points.push_back(centre + radius * btVector3(r * std::cos(angle), y, r * std::sin(angle)));
    }
    btSoftBody* body = btSoftBodyHelpers::CreateFromConvexHull(info, points.data(), n,
                                                               /*randomizeConstraints=*/false);
    shuffleLinks(body);
    return body;
}

btSoftBody* createTorus(btSoftBodyWorldInfo& info) {
    constexpr int kRound = 30, kTube = 10;
    std::vector<btScalar> vertices;
    std::vector<int> faces;
    for (int i = 0; i < kRound; ++i)
        for (int k = 0; k < kTube; ++k) {
            const btScalar a = SIMD_2_PI * static_cast<btScalar>(i) / kRound;
            const btScalar b = SIMD_2_PI * static_cast<btScalar>(k) / kTube;
            const btScalar r = 2 + 0.5f * std::cos(b);
            vertices.insert(vertices.end(), {r * std::cos(a), 0.5f * std::sin(b), r * std::sin(a)});
            const int ahead = (i + 1) % kRound * kTube, here = i * kTube, up = (k + 1) % kTube;
            faces.insert(faces.end(), {here + k, here + up, ahead + up});
            faces.insert(faces.end(), {here + k, ahead + up, ahead + k});
        }
    return bodyOf(info, vertices, faces);
}

btSoftBody* createHare(btSoftBodyWorldInfo& info) {
    const std::unique_ptr<btSoftBody> ball(createBall(info, {0, 0, 0}, 1, 453));
    std::vector<btScalar> vertices;
    std::vector<int> faces;
    for (int i = 0; i < ball->m_nodes.size(); ++i) {
        const btVector3& unit = ball->m_nodes[i].m_x;
        const btScalar x = 0.45f * unit.x(), z = 0.98f * unit.z();
        const btScalar aside = std::abs(x) - 0.2f, ahead = z - 0.3f;
        const btScalar ear = std::exp(-(aside * aside + ahead * ahead) / 0.02f);
        const btScalar y = 0.55f * unit.y() - 0.1f + (unit.y() > 0 ? 0.4f * ear : 0);
        vertices.insert(vertices.end(), {x, y, z});
    }
    for (int f = 0; f < ball->m_faces.size(); ++f)
        for (const btSoftBody::Node* node : ball->m_faces[f].m_n)
            faces.push_back(static_cast<int>(node - &ball->m_nodes[0]));
    return bodyOf(info, vertices, faces);
}
