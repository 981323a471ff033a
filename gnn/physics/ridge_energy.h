#pragma once

#include <array>
#include <vector>

#include "collision/proximity.h"
#include "gnn/physics/block_pattern.h"

namespace cloth {

/// Contact of points within faces and on edges that bend over ridges of obstacles:
/// E = sum w max(0, eps - d_k)^3, where d_k is the distance of the point, a fixed combination of
/// its face's corners, to the tangent plane of its contact. The same law as ContactEnergy's.
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
