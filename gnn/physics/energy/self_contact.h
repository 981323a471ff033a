#pragma once

#include <Eigen/SparseCore>
#include <optional>
#include <vector>

#include "collision/self/self_contact_settings.h"
#include "collision/self/self_proximity.h"
#include "data/core/cloth_state.h"

namespace cloth {

/// Contact of a garment with itself, or between the garments in it: E = sum w_p max(0, eps - d_p)^3
/// over pairs of elements (a vertex and a face, two edges) that face each other at t.
///
/// As for obstacles, the distance d_p is that to a plane: the weights of the closest points and the
/// normal between them are those at t, so that a pair cannot change sides and the energy is convex.
///
/// w_p is the setting's weight (N/m^2, per vertex of mean area) times the area that the pair stands
/// for, over the number of pairs of its elements: the force on a piece of cloth does not depend on
/// how many pairs its mesh makes.
class SelfContactEnergy {
 public:
    /// A pair as a row of a linear map: distance(x) = normal . sum of weight x.
    struct Pair {
        std::array<int, 4> vertex;     ///< the vertex and the face's, or two of each edge
        std::array<double, 4> weight;  ///< 1 and -1 on either side
        Vec3 normal;                   ///< unit, to the side of the first vertex
        double stiffness;              ///< w_p (N/m^2)
        double start;                  ///< distance at t (m)
        double mass;                   ///< that the pair stands for (kg)

        double distance(const Points& x) const {
            const auto at = [&](size_t k) { return weight[k] * x.row(vertex[k]); };
            return (at(0) + at(1) + at(2) + at(3)).dot(normal.transpose());
        }
    };

    /// Off, and without cost, if the settings say so.
    /// @throws ArgumentError if a setting is out of range
    SelfContactEnergy(const Garment& garment, const SelfContactSettings& settings);

    bool on() const { return m_settings.on(); }
    double thickness() const { return m_settings.thickness; }  ///< eps (m)
    double friction() const { return m_settings.friction; }

    /// Finds the pairs that are near at t, or would be on the way to t + dt with the velocities at
    /// t.
    /// @param unrepelled  |V|, or empty: vertices whose pairs are left out, for they may be on the
    ///                    wrong side, and hold a tangle
    void begin_step(const ClothState& state, double dt, const std::vector<char>& unrepelled = {});

    double value(const Points& x) const;
    /// Adds dE/dx (|V| x 3, N) to `gradient` and returns the energy (J).
    double add_gradient(const Points& x, Points& gradient) const;
    /// Adds the Hessian (N/m), positive semi-definite, to a matrix (3|V| x 3|V|, both triangles),
    /// whose sparsity grows by that of all pairs; rows and columns of pinned vertices stay out.
    void add_hessian(const Points& x, Eigen::SparseMatrix<double>& hessian) const;

    /// One sweep over the pairs that moves vertices of `x` (|V| x 3), but no pinned ones, so that
    /// each pair is as far apart as eps, or as at t where that is less. Keeps linear momentum.
    void separate(Points& x) const;
    /// The same for a trial step that comes from `from`: no pair gets much deeper in one step.
    void limit_entry(const Points& from, Points& trial) const;

    /// Of this step: those of a vertex and a face come first, ascending by vertex.
    const std::vector<Pair>& pairs() const { return m_pairs; }
    size_t vertex_pairs() const { return m_pairs_of_vertices; }  ///< so many have a vertex

 private:
    void take_pairs(const std::vector<char>& unrepelled);
    void lift(const Pair& pair, double height, Points& x) const;

    SelfContactSettings m_settings;
    std::optional<SelfProximity> m_proximity;
    VectorX m_inverse_masses;                       ///< |V| (1/kg), 0 for pins
    VectorX m_area;                                 ///< |V|, over the mean
    double m_mean_mass = 0.0;                       ///< (kg)
    Points m_motion;                                ///< |V| x 3 (m)
    std::vector<int> m_vertex_pairs, m_edge_pairs;  ///< |V|, |E|: pairs of an element
    std::vector<Pair> m_pairs;
    size_t m_pairs_of_vertices = 0;
};

}  // namespace cloth
