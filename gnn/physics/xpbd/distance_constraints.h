#pragma once

#include <vector>

#include "gnn/physics/xpbd/spring_net.h"

namespace cloth {

/// Points with a fourth column that is 0: a row is one vector register.
using PaddedPoints = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;  ///< (N x 4)

/// Springs as XPBD's compliant distance constraints (Macklin et al. 2016), relaxed one after the
/// other (Gauss-Seidel): each pass moves the ends of every spring by
///
///     dx_a = w_a dl d,   dx_b = -w_b dl d,   dl = (C - alpha l) / (w_a + w_b + alpha)
///
/// with w the inverse masses (1/kg), d the unit vector from a to b, C the extension (m), l the
/// multiplier so far and alpha = 1 / (k h^2) the compliance over the time step squared.
///
/// One pass leaves springs softer than they are, by about k h^2 (w_a + w_b). Over-relaxation
/// multiplies dl / C, but not beyond k h^2, the spring's own force. With many substeps that is too
/// much: a strip of soft cotton hangs 5 % too short with 1.2 and 100 substeps of 1/30 s.
///
/// Constraints are coloured greedily: no two of a colour share a vertex, so a colour's constraints
/// are independent and overlap in the processor. Their order is fixed: equal inputs give equal
/// bits. One thread does it: a colour of a 4,000-vertex garment takes 6 microseconds, no more than
/// it takes to start and join threads.
class DistanceConstraints {
 public:
    /// @param springs  those without stiffness, as of fabric that does not resist bending, are left
    ///                 out: their compliance is infinite
    /// @param inverse_masses  |V| (1/kg); 0: the vertex is held
    /// @param relaxation  1 to 2; 1: none over
    DistanceConstraints(const std::vector<Spring>& springs, const VectorX& inverse_masses,
                        double relaxation = 1.0);

    /// Sets the time step of the passes (s). Allocates nothing.
    void set_time_step(double h);

    /// One pass over all constraints. @param x  |V| x 4 (m)
    /// @param first  the first pass of a time step: all multipliers start at 0
    void relax(PaddedPoints& x, bool first);

    size_t size() const { return m_rest.size(); }
    /// Ends of the constraints in the order of a pass: (a, b), (a, b), ...
    const std::vector<int>& vertices() const { return m_vertices; }
    /// Constraints colours()[c] .. colours()[c + 1] - 1 have colour c.
    const std::vector<int>& colours() const { return m_colours; }

 private:
    void relax_run(double* x, int begin, int count, bool first);

    std::vector<int> m_vertices, m_colours;
    std::vector<double> m_rest, m_max_extension, m_stiffness;
    std::vector<double> m_mass_a, m_mass_b;  ///< inverse (1/kg)
    std::vector<double> m_alpha;             ///< 1 / (k h^2) (1/kg)
    std::vector<double> m_share;             ///< dl / C where l is 0 (kg)
    double m_relaxation;
    std::vector<double> m_multiplier;  ///< l (kg m)
};

}  // namespace cloth
