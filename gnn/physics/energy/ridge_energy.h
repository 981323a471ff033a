#pragma once

#include <array>
#include <vector>

#include "collision/proximity/proximity.h"
#include "gnn/physics/energy/block_pattern.h"

namespace cloth {

/// Contact of points within faces and on edges that bend over ridges of obstacles. The distance d_k
/// of such a point, a fixed combination of its face's corners, is that to the tangent plane of its
/// contact. Down to a depth D = eps - d_k of 0.2 mm the law is ContactEnergy's, w D^3; below, where
/// vertices would have been kept out by the guess and faces are not, it goes on with the stiffness
/// that it has there, so that solvers meet no stiffer contact than they are made for.
class RidgeEnergy {
 public:
    explicit RidgeEnergy(const Garment& garment) : m_garment(&garment) {}

    /// One contact as the solvers see it; unused corners have weight 0.
    struct Plane {
        int face;
        std::array<int, 3> vertex;
        std::array<double, 3> weight;
        Vec3 normal;
        double offset;  ///< eps + height of the surface (m): the energy starts below this height

        double depth(const Points& x) const {
            double height = 0.0;
            for (size_t k = 0; k < 3; ++k) height += weight[k] * x.row(vertex[k]).dot(normal);
            return offset - height;
        }
    };

    /// @param distance  eps (m); 0 or less: no such contacts
    void begin_step(const SurfaceContacts& contacts, double distance);

    /// Energy (J), force (N) and stiffness (N/m) at a depth (m); zero where it is negative.
    struct Law {
        double energy, force, stiffness;
    };
    static Law law(double depth, double weight);

    const std::vector<Plane>& planes() const { return m_planes; }

    /// @param weight  w (N/m^2)
    double value(const Points& x, double weight) const;
    /// Adds dE/dx (|V| x 3, N) to `gradient` and returns the energy (J).
    double add_gradient(const Points& x, double weight, Points& gradient) const;
    /// Adds the Hessian (N/m), positive semi-definite by itself, to a matrix of `pattern`.
    void add_hessian(const Points& x, double weight, const BlockPattern& pattern,
                     double* values) const;

 private:
    const Garment* m_garment;
    std::vector<Plane> m_planes;
};

}  // namespace cloth
