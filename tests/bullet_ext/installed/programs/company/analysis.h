#pragma once

#include <Eigen/Core>

/// Exercises what Eigen has of allocations, products and sparse solvers.
double analysed(int n);

/// Takes an array of Eigen's, which a file with another Eigen cannot give.
double mean(const Eigen::VectorXd& values);
