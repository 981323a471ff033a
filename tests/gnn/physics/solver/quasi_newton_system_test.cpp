// Equal garments share the constants of the quasi-Newton method, and nobody can tell.

#include "gnn/physics/solver/quasi_newton_system.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "gnn/physics/solver/quasi_newton.h"
#include "tests/gnn/physics/solver/solver_scenes.h"
#include "tests/test_meshes.h"

namespace cloth::quasi_newton_system_test {

using namespace cloth::test;

namespace {

constexpr double dt = 1.0 / 30.0;

Garment sheet_of(const Fabric& fabric = Fabric::soft_cotton(), const std::vector<int>& pins = {}) {
    return {"sheet", sheet(12, 0.5, 0.3), fabric, pins};
}

/// P^-1 of a gradient.
Points preconditioned(const Garment& garment, double time_step) {
    QuasiNewton solver(garment);
    EXPECT_TRUE(solver.prepare(garment, time_step));
    Points out;
    solver.precondition(garment.rest().vertices, out);
    return out;
}

}  // namespace

TEST(QuasiNewtonSystem, EqualGarmentsShareOneFactor) {
    const auto first = QuasiNewtonSystem::of(sheet_of());
    const auto second = QuasiNewtonSystem::of(sheet_of());
    EXPECT_EQ(first, second);
    const auto factor = first->factor(dt);
    EXPECT_EQ(second->factor(dt), factor);
    EXPECT_NE(second->factor(0.5 * dt), factor);

    QuasiNewtonMatrix a(sheet_of()), b(sheet_of());
    EXPECT_EQ(&a.system(), &b.system());
}

TEST(QuasiNewtonSystem, GarmentsThatDifferInABitShareNone) {
    const auto system = QuasiNewtonSystem::of(sheet_of());
    TriMesh moved = sheet(12, 0.5, 0.3);
    moved.vertices(7, 1) = std::nextafter(moved.vertices(7, 1), 1.0);
    EXPECT_NE(QuasiNewtonSystem::of({"sheet", moved, Fabric::soft_cotton()}), system);
    EXPECT_NE(QuasiNewtonSystem::of(sheet_of(Fabric::real_cotton())), system);
    EXPECT_NE(QuasiNewtonSystem::of(sheet_of(Fabric::soft_cotton(), {3})), system);
    Fabric stiff_to_bend = Fabric::soft_cotton();
    stiff_to_bend.bending *= 2.0;
    EXPECT_EQ(QuasiNewtonSystem::of(sheet_of(stiff_to_bend)), system) << "P knows no bending";
}

TEST(QuasiNewtonSystem, ASharedFactorGivesTheBitsOfAnOwnOne) {
    const Garment garment = sheet_of(Fabric::soft_cotton(), {0, 11});
    const Points alone = preconditioned(garment, dt);  // that solver is gone
    QuasiNewton other(garment);
    ASSERT_TRUE(other.prepare(garment, dt));
    ASSERT_TRUE(other.prepare(garment, 0.25 * dt));
    EXPECT_EQ(preconditioned(garment, dt), alone);
}

TEST(QuasiNewtonSystem, AFactorLivesAsLongAsSomebodyUsesIt) {
    const auto system = QuasiNewtonSystem::of(sheet_of());
    std::weak_ptr<const QuasiNewtonSystem::Factor> factor;
    {
        QuasiNewtonMatrix matrix(sheet_of());
        ASSERT_TRUE(matrix.prepare(sheet_of(), dt));
        factor = system->factor(dt);
        EXPECT_FALSE(factor.expired());
    }
    EXPECT_TRUE(factor.expired());
}

TEST(QuasiNewtonSystem, ThreadsSolveWithOneFactorAtOnce) {
    const Garment garment = sheet_of();
    const Points expected = preconditioned(garment, dt);
    std::vector<Points> found(4);
    std::vector<std::thread> threads;
    for (Points& out : found) threads.emplace_back([&] { out = preconditioned(garment, dt); });
    for (std::thread& thread : threads) thread.join();
    for (const Points& out : found) EXPECT_EQ(out, expected);
}

/// The pattern is found by whoever asks first.
TEST(LazyBlockPattern, ThreadsMayAskForTheFirstHessianAtOnce) {
    const SolverScene scene = swinging_sheet(8);
    IncrementalPotential potential(scene.garment);
    potential.begin_step(scene.state, scene.boundary, {}, dt);
    std::vector<Eigen::SparseMatrix<double>> found(3);
    std::vector<std::thread> threads;
    for (auto& hessian : found)
        threads.emplace_back([&] { potential.hessian(scene.state.x, hessian); });
    for (std::thread& thread : threads) thread.join();
    ASSERT_GT(found[0].nonZeros(), 0);
    for (const auto& hessian : found) EXPECT_EQ((hessian - found[0]).norm(), 0.0);
}

}  // namespace cloth::quasi_newton_system_test
