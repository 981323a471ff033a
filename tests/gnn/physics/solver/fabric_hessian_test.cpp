#include "gnn/physics/solver/fabric_hessian.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cstring>

#include "gnn/physics/solver/hessian_cg.h"
#include "gnn/physics/solver/quasi_newton.h"
#include "gnn/physics/stepper/guess.h"
#include "tests/gnn/physics/solver/solver_scenes.h"

namespace cloth::fabric_hessian_test {
namespace {

using test::deformed;
using test::noise;
using test::sheet;

constexpr double dt = 1.0 / 120.0;

/// A FabricHessian at x as a dense matrix of the free vertices (3n x 3n), in the order of the rows.
template <class Real>
Eigen::MatrixXd dense(const Garment& garment, const Points& x) {
    const auto system = QuasiNewtonSystem::of(garment);
    FabricHessian<Real> hessian(garment, *system);
    hessian.begin_step(*system, dt);
    hessian.linearise_faces(0, x);
    hessian.linearise_faces(1, x);
    const size_t rows = system->free().size();
    for (size_t row = 0; row < rows; ++row) hessian.linearise_row(row);
    Eigen::MatrixXd matrix(3 * rows, 3 * rows);
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
        std::vector<Real> unit(4 * rows, Real(0));
        unit[static_cast<size_t>(4 * (column / 3) + column % 3)] = Real(1);
        for (size_t row = 0; row < rows; ++row) {
            const auto product = hessian.product(row, unit.data());
            for (int k = 0; k < 3; ++k)
                matrix(static_cast<Eigen::Index>(3 * row) + k, column) = double(product[k]);
        }
    }
    return matrix;
}

/// What Newton's method has: of inertia, strain and bending, in the same order.
Eigen::MatrixXd oracle(const Garment& garment, const Points& x) {
    IncrementalPotential potential(garment);
    Boundary boundary;
    boundary.pin_targets = test::rows_of(x, garment.pins());
    potential.begin_step({x, Points::Zero(x.rows(), 3), 0.0}, boundary, SurfaceContacts(), dt);
    Eigen::SparseMatrix<double> sparse;
    potential.hessian(x, sparse, HessianKind::projected);
    const Eigen::MatrixXd all = sparse;
    const auto system = QuasiNewtonSystem::of(garment);
    const std::vector<int>& free = system->free();
    const auto count = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd matrix(3 * count, 3 * count);
    for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index j = 0; j < count; ++j)
            matrix.block<3, 3>(3 * i, 3 * j) =
                all.block<3, 3>(3 * free[static_cast<size_t>(i)], 3 * free[static_cast<size_t>(j)]);
    return matrix;
}

double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

TEST(FabricHessian, OfTheFlatSheetAtRestIsNewtons) {
    Fabric fabric = Fabric::real_cotton();
    fabric.bending = 1.0;  // so that it is seen beside the strain
    const Garment garment("sheet", sheet(6, 0.3), fabric, {0, 5});
    const Points& rest = garment.rest().vertices;
    const Eigen::MatrixXd with = dense<double>(garment, rest);
    // Newton's bending acts along the normal only; here all coordinates have it.
    const Eigen::MatrixXd newton = oracle(garment, rest);
    for (Eigen::Index i = 1; i < with.rows(); i += 3)
        for (Eigen::Index j = 1; j < with.cols(); j += 3)
            EXPECT_NEAR(with(i, j), newton(i, j), 1e-9 * newton.cwiseAbs().maxCoeff());
    fabric.bending = 1e-12;
    const Garment limp("sheet", sheet(6, 0.3), fabric, {0, 5});
    EXPECT_LT(difference(dense<double>(limp, rest), oracle(limp, rest)), 1e-9);
}

TEST(FabricHessian, OfStretchedClothIsNewtons) {
    Fabric fabric = Fabric::real_cotton();
    fabric.bending = 1e-12;
    const Garment garment("sheet", sheet(7, 0.3), fabric, {0});
    Points x = 1.1 * garment.rest().vertices;
    x += noise(x.rows(), 1e-4, 3);
    const Eigen::MatrixXd newton = oracle(garment, x);
    EXPECT_LT(difference(dense<double>(garment, x), newton), 1e-9);
    EXPECT_LT(difference(dense<float>(garment, x), newton), 1e-6);
}

TEST(FabricHessian, IsPositiveDefiniteAndSymmetricWhereClothIsCompressed) {
    const Garment garment("sheet", sheet(7, 0.3), Fabric::real_cotton(), {0, 6});
    for (unsigned seed = 1; seed <= 10; ++seed) {
        const Points x = (seed % 2 ? 0.7 : 1.0) * deformed(garment, seed);
        const Eigen::MatrixXd matrix = dense<double>(garment, x);
        EXPECT_LT((matrix - matrix.transpose()).cwiseAbs().maxCoeff(),
                  1e-12 * matrix.cwiseAbs().maxCoeff());
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
        EXPECT_GE(solver.eigenvalues().minCoeff(),
                  (1.0 - 1e-6) * garment.masses().minCoeff() / (dt * dt));
    }
}

TEST(FabricHessian, FollowsTheFabric) {
    const Garment garment("sheet", sheet(5, 0.3), Fabric::real_cotton());
    const FabricHessian<double> hessian(garment, *QuasiNewtonSystem::of(garment));
    EXPECT_TRUE(hessian.is_of(garment.fabric()));
    Fabric stiffer = garment.fabric();
    stiffer.bending *= 2.0;
    EXPECT_FALSE(hessian.is_of(stiffer));
    EXPECT_FALSE(hessian.is_of(Fabric::soft_cotton()));
}

/// A sheet on a sphere, with contacts that are deep and ridges.
struct OnSphere {
    explicit OnSphere(int n, const Fabric& fabric)
        : scene(test::sheet_on_sphere(n, fabric)),
          potential(scene.garment),
          matrix(scene.garment),
          x(scene.state.x) {
        SurfaceContacts near;
        Proximity().query(x, scene.boundary, near);
        for (int face = 0; face < scene.garment.face_count(); face += 7)
            near.ridges.push_back({face, {0.5, 0.2, 0.3}, Vec3(0.1, 1, 0.2).normalized(), 0.0});
        potential.begin_step(scene.state, scene.boundary, near, dt);
        EXPECT_TRUE(matrix.prepare(scene.garment, dt));
        contacts.begin_step(potential, matrix.row_of());
        x.col(1).array() -= 3e-3;
        x += noise(x.rows(), 1e-3, 7);
        b = noise(matrix.free_count(), 1e-3, 5);
    }
    Points solve(int iterations) {
        Points found;
        contacts.linearise(potential, x);
        matrix.solve(scene.garment, x, b, contacts, iterations, found);
        return found;
    }
    test::SolverScene scene;
    IncrementalPotential potential;
    QuasiNewtonMatrix matrix;
    ContactHessian contacts;
    Points x, b;
};

TEST(HessianCg, SolvesWithContacts) {
    for (const Fabric& fabric : {Fabric::soft_cotton(), Fabric::real_cotton()}) {
        OnSphere scene(12, fabric);
        const Points found = scene.solve(200);
        Eigen::MatrixXd matrix = dense<double>(scene.scene.garment, scene.x);
        for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
            Points unit = Points::Zero(found.rows(), 3), product = unit;
            unit.data()[k] = 1.0;
            scene.contacts.add_product(unit, product);
            matrix.col(k) += Eigen::Map<const VectorX>(product.data(), product.size());
        }
        const VectorX right = Eigen::Map<const VectorX>(scene.b.data(), scene.b.size());
        const VectorX expected = matrix.ldlt().solve(right);
        const Eigen::Map<const VectorX> answer(found.data(), found.size());
        // In the norm of the matrix, in which conjugate gradients end at a thousandth of P's.
        const VectorX error = answer - expected;
        EXPECT_LT(error.dot(matrix * error), 1e-4 * expected.dot(matrix * expected));
    }
}

TEST(HessianCg, GivesTheSameBitsForAnyNumberOfThreads) {
    OnSphere scene(40, Fabric::real_cotton());
    const int before = omp_get_max_threads();
    omp_set_num_threads(1);
    const Points alone = scene.solve(8);
    omp_set_num_threads(2);
    const Points together = scene.solve(8);
    omp_set_num_threads(before);
    ASSERT_EQ(alone.size(), together.size());
    EXPECT_EQ(std::memcmp(alone.data(), together.data(),
                          sizeof(double) * static_cast<size_t>(alone.size())),
              0);
}

TEST(HessianCg, TwoNewtonStepsOfStiffClothGetFartherThanTwentyWithAHistory) {
    const test::SolverScene scene = test::swinging_sheet(20, Fabric::real_cotton());
    IncrementalPotential potential(scene.garment);
    potential.begin_step(scene.state, scene.boundary, SurfaceContacts(), dt);
    const auto energy_after = [&](int iterations, int cg) {
        QuasiNewtonSettings settings = IterationLimits::exactly(iterations);
        settings.hessian_cg_iterations = cg;
        Points x;
        starting_guess(scene.garment, scene.state, scene.boundary, SurfaceContacts(), dt,
                       potential.settings().contact_distance, x);
        return QuasiNewton(scene.garment, settings).minimise(potential, x).energy;
    };
    const double converged = energy_after(400, 0);
    EXPECT_LT(energy_after(2, 20) - converged, energy_after(20, 0) - converged);
}

}  // namespace
}  // namespace cloth::fabric_hessian_test
