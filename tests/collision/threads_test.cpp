// Stages of a step that share their loops among threads: the results are those of one thread, to
// the bit. Meshes are large enough for all loops to be shared.

#include <gtest/gtest.h>
#include <omp.h>

#include "collision/proximity/closest_face_tree.h"
#include "collision/proximity/limb_overlap.h"
#include "collision/proximity/ridge_contacts.h"
#include "collision/response/contact_projection.h"
#include "data/authoring/sheet.h"
#include "data/core/triangle.h"
#include "tests/collision/proximity/same_bits.h"
#include "tests/test_meshes.h"

namespace cloth::threads_test {
namespace {

using namespace test;

constexpr double dt = 1.0 / 30.0;

/// Restores the number of threads.
class Threads {
 public:
    explicit Threads(int count) : m_before(omp_get_max_threads()) { omp_set_num_threads(count); }
    ~Threads() { omp_set_num_threads(m_before); }
    Threads(const Threads&) = delete;
    Threads& operator=(const Threads&) = delete;

 private:
    int m_before;
};

/// A rough ball with three smaller ones, one mesh: limb 1 is joined to the ball, 2 and 3 are not.
Obstacle rough_body(double at0, double at1) {
    const TriMesh ball = roughened(icosphere(4), 0.05, 7);
    const Eigen::Index vertices = ball.vertices.rows(), faces = ball.faces.rows();
    Obstacle body;
    Faces all(4 * faces + 1, 3);
    auto limbs = std::make_shared<std::vector<std::uint8_t>>(size_t(all.rows()), 1);
    body.x0.resize(4 * vertices, 3);
    for (int k = 0; k < 4; ++k) {
        all.middleRows(k * faces, faces) = ball.faces.array() + k * int(vertices);
        std::fill_n(limbs->begin() + k * faces, faces, std::uint8_t(k));
        body.x0.middleRows(k * vertices, vertices) = (k == 0 ? 0.15 : 0.06) * ball.vertices;
    }
    all.bottomRows(1) << 0, int(vertices), int(vertices);
    body.x1 = body.x0;
    const auto place = [&](Points& x, double at) {
        x.middleRows(vertices, vertices).rowwise() += Eigen::RowVector3d(at, 0.1, 0);
        x.middleRows(2 * vertices, vertices).rowwise() += Eigen::RowVector3d(0, at, 0.02);
        x.middleRows(3 * vertices, vertices).rowwise() += Eigen::RowVector3d(0, 0.05, at);
    };
    place(body.x0, at0);
    place(body.x1, at1);
    body.faces = std::make_shared<const Faces>(all);
    body.limbs = limbs;
    return body;
}

/// What three steps of the stages make of a sheet over the body.
struct Results {
    std::vector<std::vector<LimbSet>> ignored;
    std::vector<SurfaceContacts> contacts;
    std::vector<Points> x;
    size_t ridges = 0;
    int rounds = 0;
    bool any_ignored = false;

    explicit Results(int threads) {
        const Threads together(threads);
        const Garment garment("sheet", make_sheet(0.4, 0.4, 2500), Fabric::soft_cotton());
        ClothState state{garment.rest().vertices, Points::Zero(garment.vertex_count(), 3)};
        for (Eigen::Index i = 0; i < state.x.rows(); ++i)  // a cap over the ball
            state.x(i, 1) = 0.16 - 1.5 * state.x.row(i).squaredNorm();
        LimbOverlap limbs;
        Proximity proximity;
        RidgeFinder ridge_finder(garment);
        ContactProjection projection(garment);
        for (int frame = 0; frame < 3; ++frame) {
            const double at = 0.2 - 0.03 * frame;
            Boundary boundary = boundary_of({rough_body(at, at - 0.03)});
            const Boundary& outside = limbs.filter(boundary, dt, state);
            ignored.push_back(limbs.ignored());
            for (const LimbSet set : limbs.ignored()) any_ignored |= set != 0;
            SurfaceContacts& near = contacts.emplace_back();
            proximity.query(state.x, outside, near);
            ridge_finder.find(proximity, outside, state.x, near);
            ridges += near.ridges.size();
            rounds += projection.resolve(proximity, outside, 5e-4, state.x, contacts.emplace_back())
                          .surface_iterations;
            x.push_back(state.x);
        }
    }
};

TEST(Threads, StagesOfAStepDoNotDependOnTheirNumber) {
    const Results expected(1);
    EXPECT_TRUE(expected.any_ignored);
    EXPECT_GT(expected.ridges, 10u);
    EXPECT_GT(expected.rounds, 2);
    for (const int threads : {2, 3}) {
        const Results results(threads);
        EXPECT_EQ(results.ignored, expected.ignored);
        EXPECT_EQ(results.ridges, expected.ridges);
        for (size_t k = 0; k < expected.contacts.size(); ++k)
            expect_same_bits(results.contacts[k], expected.contacts[k]);
        for (size_t k = 0; k < expected.x.size(); ++k) EXPECT_EQ(results.x[k], expected.x[k]);
    }
}

/// A tree that several threads fit answers as one that was built by one thread there.
TEST(Threads, FitATreeAsOneThreadDoes) {
    std::mt19937 random(4);
    Obstacle body = rough_body(0.2, 0.1);
    body.x1.row(17).setConstant(std::numeric_limits<double>::quiet_NaN());
    body.x1.row(18).setConstant(-std::numeric_limits<double>::infinity());
    const Points poses[] = {body.x0, body.x1, body.x0.rowwise() + Eigen::RowVector3d(50, -3, 700)};
    for (const int threads : {1, 2, 3})
        for (const Points& pose : poses) {
            ClosestFaceTree::Stack stack;
            ClosestFaceTree moved(poses[0], *body.faces, 0.5, body.limbs.get());
            {
                const Threads together(threads);
                moved.refit(pose);
            }
            for (int k = 0; k < 200; ++k) {
                const Vec3 q = random_point(random, 0.3) + Vec3(pose.row(0));
                FaceHit slow;
                slow.squared = 0.25;
                for (int f = 0; f < int(body.faces->rows()); ++f) {
                    const Vec3 a = pose.row((*body.faces)(f, 0)), b = pose.row((*body.faces)(f, 1)),
                               c = pose.row((*body.faces)(f, 2));
                    if (!has_area(a, b, c)) continue;
                    const TriangleHit hit = closest_on_triangle(q, a, b, c);
                    if (hit.squared < slow.squared) slow = {f, hit.barycentric, hit.squared};
                }
                const FaceHit hit = moved.closest(q, 0.5, -1, stack);
                EXPECT_EQ(hit.face, slow.face);
                EXPECT_NEAR(hit.squared, slow.squared, 1e-12);
            }
        }
}

}  // namespace
}  // namespace cloth::threads_test
