#include <gtest/gtest.h>

#include "bullet_ext/garmentSoftBody.h"
#include "bullet_ext/softBodyGarment.h"
#include "data/core/errors.h"
#include "tests/bullet_ext/bullet_world.h"

namespace cloth::soft_body_garment_test {

using namespace cloth::test;

namespace {

/// True if every inner edge is used once in each direction.
bool is_oriented(const Faces& faces) {
    std::vector<std::pair<int, int>> half_edges;
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int c = 0; c < 3; ++c) half_edges.emplace_back(faces(f, c), faces(f, (c + 1) % 3));
    std::sort(half_edges.begin(), half_edges.end());
    return std::adjacent_find(half_edges.begin(), half_edges.end()) == half_edges.end();
}

Garment garment_of(const btSoftBody& body, bool density = false) {
    return garmentOfSoftBody(body, Fabric::soft_cotton(), density);
}

double max_length_error(const Garment& a, const Garment& b) {
    double error = 0.0;
    for (const auto& [i, j] : a.edges()) {
        const double la = (a.rest().vertices.row(i) - a.rest().vertices.row(j)).norm();
        const double lb = (b.rest().vertices.row(i) - b.rest().vertices.row(j)).norm();
        error = std::max(error, std::abs(la / lb - 1.0));
    }
    return error;
}

}  // namespace

TEST(SoftBodyGarment, PatchBecomesASheetWithItsPins) {
    btSoftBodyWorldInfo info;
    const std::unique_ptr<btSoftBody> body(patch(info, {0, 1, 0}, 6, 1 + 8));
    const Garment garment = garment_of(*body);
    EXPECT_EQ(garment.vertex_count(), 36);
    EXPECT_EQ(garment.face_count(), 50);
    EXPECT_EQ(garment.pins(), (std::vector<int>{0, 35}));
    EXPECT_TRUE(is_oriented(garment.rest().faces));
    EXPECT_NEAR(garment.face_areas().sum(), 1.0, 1e-5);
    EXPECT_EQ(garment.fabric().density, Fabric::soft_cotton().density);
}

TEST(SoftBodyGarment, ShuffledAndTurnedFacesAreOriented) {
    btSoftBodyWorldInfo info;
    const std::unique_ptr<btSoftBody> body(patch(info, {0, 1, 0}, 6));
    body->randomizeConstraints();
    for (int f = 0; f < body->m_faces.size(); f += 3)
        std::swap(body->m_faces[f].m_n[1], body->m_faces[f].m_n[2]);
    ASSERT_FALSE(is_oriented(faceNodes(*body)));
    EXPECT_TRUE(is_oriented(garment_of(*body).rest().faces));
}

TEST(SoftBodyGarment, BodyDensityIsMassOverAreaOfTheFreeNodes) {
    btSoftBodyWorldInfo info;
    const std::unique_ptr<btSoftBody> body(patch(info, {0, 1, 0}, 6));
    body->setTotalMass(0.3f, true);
    EXPECT_NEAR(garment_of(*body, true).fabric().density, 0.3, 1e-4);
    for (int i = 0; i < body->m_nodes.size(); ++i) body->setMass(i, 0);
    EXPECT_THROW(garment_of(*body, true), ArgumentError);
    EXPECT_NO_THROW(garment_of(*body, false));
}

TEST(SoftBodyGarment, RestLengthsOfTheLinksCountOnceBulletHasStepped) {
    btSoftBodyWorldInfo info;
    const std::unique_ptr<btSoftBody> body(patch(info, {0, 1, 0}, 8));
    const Garment flat = garment_of(*body);
    for (int i = 0; i < body->m_nodes.size(); ++i) {
        btVector3& x = body->m_nodes[i].m_x;
        x += btVector3(0.02f * std::sin(9 * x.z()), 0.1f * std::sin(6 * x.x()), 0.05f * x.z());
    }
    // Before its first step Bullet takes the shape as it is.
    EXPECT_GT(max_length_error(garment_of(*body), flat), 0.02);
    const std::unique_ptr<btSoftBody> stepped(patch(info, {0, 1, 0}, 8));
    stepped->updateConstants();
    stepped->m_bUpdateRtCst = false;
    for (int i = 0; i < body->m_nodes.size(); ++i) stepped->m_nodes[i].m_x = body->m_nodes[i].m_x;
    EXPECT_LT(max_length_error(garment_of(*stepped), flat), 1e-3);
}

TEST(SoftBodyGarment, BadBodiesAreRefusedWithPlaceAndRemedy) {
    btSoftBodyWorldInfo info;
    const auto error_of = [&](auto spoil) -> std::string {
        const std::unique_ptr<btSoftBody> body(patch(info, {0, 1, 0}, 4));
        body->setUserIndex(5);
        spoil(*body);
        try {
            garment_of(*body);
        } catch (const ArgumentError& error) {
            return error.what();
        }
        return "no error";
    };
    const auto expect = [](const std::string& text, const std::string& part) {
        EXPECT_NE(text.find(part), std::string::npos) << text;
        EXPECT_NE(text.find("soft body 5"), std::string::npos) << text;
        EXPECT_NE(text.find("Remedy: "), std::string::npos) << text;
    };
    expect(error_of([](btSoftBody& b) { b.m_nodes[3].m_im = -1; }), "node 3");
    expect(error_of([](btSoftBody& b) { b.appendNode({0, 0, 0}, 1); }), "belongs to no face");
    expect(error_of([](btSoftBody& b) {
               b.appendFace(0, 1, 9);
               b.appendFace(0, 1, 10);
           }),
           "more than two faces");
    expect(error_of([](btSoftBody& b) { b.appendFace(0, 1, 2); }), "no area");
    expect(error_of([](btSoftBody& b) { b.m_faces.clear(); }), "no faces");
}

TEST(SoftBodyGarment, AMoebiusStripHasNoInside) {
    btSoftBodyWorldInfo info;
    constexpr int kRungs = 12;
    std::vector<btVector3> x;
    std::vector<btScalar> masses(2 * kRungs, 1);
    for (int i = 0; i < kRungs; ++i) {
        const double t = 2 * M_PI * i / kRungs;
        for (double s : {-0.2, 0.2}) {
            const double r = 1.0 + s * std::cos(t / 2);
            x.push_back(toBullet(Vec3(r * std::cos(t), s * std::sin(t / 2), r * std::sin(t))));
        }
    }
    btSoftBody strip(&info, 2 * kRungs, x.data(), masses.data());
    for (int i = 0; i < kRungs; ++i) {
        const int a = 2 * i, b = 2 * i + 1;
        const bool last = i + 1 == kRungs;
        const int c = last ? 1 : a + 2, d = last ? 0 : b + 2;
        strip.appendFace(a, b, c);
        strip.appendFace(b, d, c);
    }
    EXPECT_THROW(garment_of(strip), ArgumentError);
}

TEST(GarmentSoftBody, BodyIsTheGarment) {
    btSoftBodyWorldInfo info;
    const std::unique_ptr<btSoftBody> source(patch(info, {0, 0, 0}, 5, 1));
    const Garment garment = garment_of(*source);
    SoftBodySettings settings;
    settings.iterations = 7;
    const std::unique_ptr<btSoftBody> body(createGarmentSoftBody(info, garment, settings));
    EXPECT_NO_THROW(checkGarmentFits(*body, garment));
    EXPECT_EQ(body->m_links.size(),
              static_cast<int>(garment.edges().size() + garment.hinges().size()));
    EXPECT_EQ(body->m_nodes[0].m_im, 0);
    EXPECT_NEAR(1.0 / static_cast<double>(body->m_nodes[12].m_im), garment.masses()[12], 1e-8);
    EXPECT_EQ(body->m_cfg.piterations, 7);
    EXPECT_EQ(body->m_cfg.kKHR, 1);
    EXPECT_NEAR(body->getCollisionShape()->getMargin(), 4e-3, 1e-9);
    const Garment again = garment_of(*body);
    EXPECT_LT(max_length_error(again, garment), 1e-6);
}

TEST(GarmentSoftBody, RestLengthsDoNotDependOnTheState) {
    btSoftBodyWorldInfo info;
    const std::unique_ptr<btSoftBody> source(patch(info, {0, 0, 0}, 5));
    const Garment garment = garment_of(*source);
    ClothState state = ClothState::at_rest(garment);
    state.x *= 1.3;
    state.v.setConstant(0.25);
    const std::unique_ptr<btSoftBody> body(createGarmentSoftBody(info, garment, state));
    const auto& [a, b] = garment.edges()[0];
    const double length = (garment.rest().vertices.row(a) - garment.rest().vertices.row(b)).norm();
    EXPECT_NEAR(body->m_links[0].m_rl, length, 1e-6);
    EXPECT_NEAR((node(*body, 3) - Vec3(state.x.row(3))).norm(), 0.0, 1e-6);
    ClothState back;
    storeState(*body, back);
    EXPECT_NEAR((back.x - state.x).norm() + (back.v - state.v).norm(), 0.0, 1e-5);
    ClothState wrong;
    wrong.x = Points::Zero(3, 3);
    EXPECT_THROW(createGarmentSoftBody(info, garment, wrong), ArgumentError);
}

}  // namespace cloth::soft_body_garment_test
