#pragma once

#include <cmath>
#include <vector>

#include "gnn/physics/energy/self_contact.h"

namespace cloth {

/// Coulomb friction between layers of cloth, for the pairs of SelfContactEnergy:
///
///     E = sum mu N_p (sqrt(s^2 + |u_p|^2) - s),
///
/// where u_p is the tangential part of the motion of one side of the pair relative to the other
/// since t, and s the smoothing slip. N_p, fixed at t, is the pair's contact force there, at most
/// `force_per_mass` times the mass that the pair stands for: what is too deep in an unconverged
/// state shall not stick. In steps in which layers slide over several edges N_p is a poor estimate:
/// at 60 Hz a sheet slides up to 1.7 times as far as Coulomb says, at 240 Hz 1.1 times. Momentum is
/// kept. Pairs are new in each step, so layers that friction holds creep: by s in a step where they
/// are pulled by 0.7 of their friction, by 3 s at 0.95.
class LayerFriction {
 public:
    /// A pair that friction acts on.
    struct Slider {
        std::array<int, 4> vertex;
        std::array<double, 4> weight;  ///< their sum is 0
        Vec3 normal;
        Vec3 start;    ///< sum of weight x at t (m)
        double force;  ///< mu N (N)
        size_t pair;   ///< index in SelfContactEnergy::pairs()

        /// u_p (m)
        Vec3 slip(const Points& x) const {
            Vec3 motion = -start;
            for (size_t k = 0; k < 4; ++k) motion += weight[k] * x.row(vertex[k]).transpose();
            return motion - normal.dot(motion) * normal;
        }
    };

    /// @param contact         of this step
    /// @param x               |V| x 3 (m): positions at t
    /// @param slip            s (m)
    /// @param force_per_mass  (m/s^2)
    void begin_step(const SelfContactEnergy& contact, const Points& x, double slip,
                    double force_per_mass);

    double value(const Points& x) const;
    /// Adds dE/dx (|V| x 3, N) to `gradient` and returns the energy (J).
    double add_gradient(const Points& x, Points& gradient) const;
    /// Adds the Hessian (N/m), positive semi-definite, to a matrix (3|V| x 3|V|, both triangles),
    /// whose sparsity holds that of the pairs' contact; rows and columns of pinned vertices stay
    /// out.
    void add_hessian(const Points& x, const std::vector<char>& pinned,
                     Eigen::SparseMatrix<double>& hessian) const;

    const std::vector<Slider>& sliders() const { return m_sliders; }
    /// sqrt(s^2 + |u|^2) (m)
    double smoothed(const Vec3& slip) const {
        return std::sqrt(m_slip * m_slip + slip.squaredNorm());
    }

 private:
    std::vector<Slider> m_sliders;
    double m_slip = 1e-4;
};

}  // namespace cloth
