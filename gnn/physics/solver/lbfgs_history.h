#pragma once

#include <vector>

#include "data/core/types.h"

namespace cloth {

/// The last few pairs of steps and gradient changes of a quasi-Newton method, and the two halves of
/// the L-BFGS product with the inverse Hessian (Nocedal and Wright, Numerical Optimization,
/// alg. 7.4):
///
///     history.first_loop(q);       // q: gradient
///     z = H0 q;                    // any symmetric positive-definite guess at the inverse Hessian
///     history.second_loop(z);      // z: inverse Hessian times gradient
class LbfgsHistory {
 public:
    /// Holds at most `capacity` pairs of (rows x 3) arrays, allocated here.
    void allocate(int capacity, Eigen::Index rows);
    void clear() { m_size = 0; }
    bool empty() const { return m_size == 0; }

    /// Appends s = x_{k+1} - x_k and y = g_{k+1} - g_k, dropping the oldest pair if full. A pair
    /// without positive curvature s . y is not kept: E is not convex there.
    void push(const Points& step, const Points& gradient_before, const Points& gradient_after);

    void first_loop(Points& q);
    void second_loop(Points& z);

 private:
    struct Pair {
        Points step;
        Points change;
        double inverse_curvature;  ///< 1 / (s . y)
        double alpha;              ///< of the first loop, for the second
    };
    Pair& pair(int age);  ///< 0: the newest

    std::vector<Pair> m_pairs;  ///< ring
    int m_size = 0;
    int m_next = 0;
};

}  // namespace cloth
