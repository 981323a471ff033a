#include "gnn/physics/solver/block_cholesky.h"

#include <omp.h>

#include <Eigen/SparseCholesky>

#include "gnn/physics/energy/incremental_potential.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::block_cholesky_test {

using namespace cloth::test;

namespace {

/// The projected Hessian of a deformed sheet of n x n vertices with two pins.
Eigen::SparseMatrix<double> sheet_hessian(int n) {
    const Garment garment("sheet", sheet(n, 0.5), Fabric::real_cotton(), {0, n - 1});
    IncrementalPotential potential(garment);
    Boundary boundary;
    potential.begin_step(ClothState::at_rest(garment), boundary, {}, 1.0 / 30.0);
    Eigen::SparseMatrix<double> hessian;
    potential.hessian(deformed(garment, 1), hessian);
    return hessian;
}

}  // namespace

TEST(BlockCholesky, SolvesLikeEigen) {
    for (int n : {2, 3, 8, 17}) {
        const Eigen::SparseMatrix<double> matrix = sheet_hessian(n);
        BlockCholesky cholesky;
        EXPECT_FALSE(cholesky.is_analysed_for(matrix));
        cholesky.analyse(matrix);
        ASSERT_TRUE(cholesky.is_analysed_for(matrix));
        ASSERT_TRUE(cholesky.factorise(matrix));
        const VectorX b = VectorX::LinSpaced(matrix.rows(), -1.0, 2.0);
        VectorX x = b;
        cholesky.solve(x);
        const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> eigen(matrix);
        const VectorX expected = eigen.solve(b);
        EXPECT_LT((x - expected).norm(), 1e-8 * expected.norm());
        EXPECT_LT((matrix * x - b).norm(), 1e-9 * b.norm());
    }
}

TEST(BlockCholesky, RefactorisesNewValuesAndShifts) {
    Eigen::SparseMatrix<double> matrix = sheet_hessian(8);
    BlockCholesky cholesky;
    cholesky.analyse(matrix);
    ASSERT_TRUE(cholesky.factorise(matrix));
    matrix *= 2.0;
    ASSERT_TRUE(cholesky.factorise(matrix, 0.5));
    VectorX b = VectorX::Ones(matrix.rows()), x = b;
    cholesky.solve(x);
    EXPECT_LT((matrix * x + 0.5 * x - b).norm(), 1e-9 * b.norm());
}

TEST(BlockCholesky, AnIndefiniteMatrixIsRefusedAndTheNextOneIsNot) {
    const Eigen::SparseMatrix<double> matrix = sheet_hessian(8);
    const Eigen::MatrixXd dense = matrix;
    const double largest = dense.cwiseAbs().rowwise().sum().maxCoeff();
    BlockCholesky cholesky;
    cholesky.analyse(matrix);
    EXPECT_FALSE(cholesky.factorise(matrix, -largest));
    ASSERT_TRUE(cholesky.factorise(matrix));
    VectorX b = VectorX::Ones(matrix.rows()), x = b;
    cholesky.solve(x);
    EXPECT_LT((matrix * x - b).norm(), 1e-9 * b.norm());
}

TEST(BlockCholesky, NotANumberIsRefused) {
    Eigen::SparseMatrix<double> matrix = sheet_hessian(4);
    BlockCholesky cholesky;
    cholesky.analyse(matrix);
    matrix.valuePtr()[matrix.nonZeros() / 2] = std::numeric_limits<double>::quiet_NaN();
    VectorX x = VectorX::Ones(matrix.rows());
    if (cholesky.factorise(matrix)) cholesky.solve(x);
    EXPECT_TRUE(!x.allFinite() || x == VectorX::Ones(matrix.rows()));
}

TEST(BlockCholesky, SameBitsForAnyNumberOfThreads) {
    const Eigen::SparseMatrix<double> matrix = sheet_hessian(42);  // large enough to go parallel
    const int threads = omp_get_max_threads();
    VectorX solutions[3];
    const int counts[3] = {1, 2, 4};
    for (int k = 0; k < 3; ++k) {
        omp_set_num_threads(counts[k]);
        BlockCholesky cholesky;
        cholesky.analyse(matrix);
        ASSERT_TRUE(cholesky.factorise(matrix));
        solutions[k] = VectorX::Ones(matrix.rows());
        cholesky.solve(solutions[k]);
    }
    omp_set_num_threads(threads);
    EXPECT_EQ(solutions[0], solutions[1]);
    EXPECT_EQ(solutions[0], solutions[2]);
}

}  // namespace cloth::block_cholesky_test
