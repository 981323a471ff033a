// Knows nothing of FastCloth, and uses Eigen with its defaults.
#include "analysis.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <vector>

double analysed(int n) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd b(n);
    for (int i = 0; i < n; ++i) {
        b[i] = i;
        a(i, (i + 1) % n) = 0.1;
    }
    a.conservativeResize(n, n);
    const Eigen::MatrixXd product = a * a.transpose();
    const Eigen::VectorXd dense = product.ldlt().solve(b);
    std::vector<Eigen::Triplet<double>> triplets;
    for (int i = 0; i < n; ++i) triplets.emplace_back(i, i, 2.0);
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(matrix);
    const Eigen::VectorXd sparse = factors.solve(b);
    Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> points(n, 3);
    points.setOnes();
    points.conservativeResize(n + 5, 3);
    points.resize(2 * n, 3);
    points.setZero();
    return dense.sum() + sparse.sum() + points.sum();
}

double mean(const Eigen::VectorXd& values) {
    return values.mean();
}
