#pragma once

#include <array>
#include <vector>

#include "gnn/physics/energy/incremental_potential.h"
#include "gnn/physics/solver/goal_hessian.h"
#include "gnn/physics/solver/lumped_edge_pairs.h"
#include "gnn/physics/solver/stiffness.h"

namespace cloth {

/// What the obstacles add to the constant matrix of the quasi-Newton method: symmetric positive
/// semi-definite blocks for each vertex or face in contact or held by friction,
///
///     contact    6 w depth n n'                         depth = eps - d > 0
///     ridge      the same, shared out over the corners of a face
///     friction   mu N / q (I - n n' - u u' / q^2),  q = sqrt(s^2 + |u|^2)
///
/// Contact is flat at depth 0, where guesses leave what only now touches, so the tangent
/// stiffness alone lets the next step fall through the surface. Two remedies: vertices that a plain
/// step would press deeper get the stiffness of the depth they are heading for (up to a limit), and
/// a trial point is never deeper than a limit beyond the point it comes from.
///
/// Contact of the garment with itself adds, with the same remedies, a term of rank one for each
/// pair of elements that is near:
///
///     6 w depth c c'         c = (weight n) of the pair's four vertices
///
/// and friction between layers the block of friction, shared out over these four.
///
/// Skinned goals add the blocks of GoalHessian.
class ContactHessian {
 public:
    /// lumped: see LumpedEdgePairs; single: a term for each, which costs more and guides no better.
    enum class EdgePairs { lumped, single };

    explicit ContactHessian(EdgePairs edge_pairs = EdgePairs::lumped)
        : m_lumps(edge_pairs == EdgePairs::lumped) {}

    /// Takes the contacts and sliders of this step. @param row_of  |V|: free row, -1 for a pin
    void begin_step(const IncrementalPotential& potential, const std::vector<int>& row_of);

    /// Linearises at x (|V| x 3).
    void linearise(const IncrementalPotential& potential, const Points& x);

    /// Once after linearise(): stiffens contacts that `step` (free, n x 3), a step without these
    /// blocks, would press deeper. Returns whether any block is not zero.
    bool anticipate(const Points& step);

    // What follows is about what anticipate() has left.

    /// What contact, friction and a goal add up to at one vertex.
    struct Block {
        int row;
        Stiffness stiffness;
    };
    /// Ascending by row, but for goals, which come last.
    const std::vector<Block>& blocks() const { return m_blocks; }

    /// What holds a weighted sum of rows: a force of stiffness * sum, shared out by the weights.
    struct Coupling {
        std::array<int, 4> row;        ///< 0 for a pin
        std::array<double, 4> weight;  ///< 0 for a pin
        Vec3 normal;
        double along;   ///< stiffness along the normal (N/m)
        double across;  ///< (N/m)
    };
    /// visit(coupling) for ridges and for self-contact with its friction, always in the same order.
    template <class Visit>
    void for_each_coupling(const Visit& visit) const;
    /// No more than these are visited before the next begin_step().
    size_t most_couplings() const { return m_ridges.size() + m_self_contacts.size(); }

    /// product += (blocks and couplings) * direction (free, n x 3), slow and obvious: solves go
    /// through ContactProduct.
    void add_product(const Points& direction, Points& product) const;

    /// Moves vertices of `trial` (|V| x 3) that are too deep out along the normal, and those that
    /// are too far from their goals back.
    void limit_depth(Points& trial) const;

    /// Whether any obstacle, or any other part of the cloth, is near enough to matter, or there are
    /// goals.
    bool active() const {
        return !m_contacts.empty() || !m_ridges.empty() || !m_sliders.empty() ||
               !m_self_contacts.empty() || m_goals.active();
    }

 private:
    struct Contact {
        Eigen::Index vertex;
        int row;
        Vec3 normal;
        double surface;          ///< eps + p . n: depth is surface - x . n (m)
        double depth = 0.0;      ///< at the point of linearisation, negative outside (m)
        double stiffness = 0.0;  ///< (N/m)
    };
    struct Ridge {
        std::array<int, 3> vertex, row;
        std::array<double, 3> weight;
        Vec3 normal;
        double surface;
        double depth = 0.0;
        double stiffness = 0.0;
    };
    struct Slider {
        int row;
        Vec3 normal;
        double stiffness = 0.0;        ///< across the slip (N/m)
        Vec3 yielding = Vec3::Zero();  ///< y: along the slip it is less, by y y'
    };

    struct SelfContact {
        std::array<int, 4> row;        ///< 0 for a pin
        std::array<double, 4> weight;  ///< 0 for a pin
        Vec3 normal;
        double pair_weight;      ///< w of this pair (N/m^2)
        double depth = 0.0;      ///< (m)
        double stiffness = 0.0;  ///< (N/m)
        double friction = 0.0;   ///< stiffness across the normal (N/m)

        double along(const Points& direction) const;  ///< of a free array (n x 3)
    };
    void begin_vertices(const IncrementalPotential& potential, const std::vector<int>& row_of);
    void begin_self_contact(const SelfContactEnergy& energy, const std::vector<int>& row_of);
    void lump_edge_pairs();
    void gather_blocks();
    static double secant(double weight, double before, double after);
    static double rise(const Ridge& ridge, const Points& step);

    double m_weight = 0.0;                      ///< w (N/m^2)
    std::vector<int> m_vertex_of, m_slider_of;  ///< n: of each free row; -1: no slider
    std::vector<Contact> m_contacts;            ///< ascending by row, as the sliders
    std::vector<Ridge> m_ridges;
    std::vector<Slider> m_sliders;
    std::vector<size_t> m_slider_index;        ///< of the potential's friction().sliders()
    std::vector<SelfContact> m_self_contacts;  ///< the potential's self_contact().pairs()
    bool m_lumps;
    LumpedEdgePairs m_edge_pairs;
    std::vector<Block> m_blocks;
    bool m_anticipated = false;
    const SelfContactEnergy* m_self = nullptr;
    GoalHessian m_goals;
    Points m_from;  ///< |V| x 3 (m): the point of linearisation, if there is self-contact
};

template <class Visit>
void ContactHessian::for_each_coupling(const Visit& visit) const {
    if (!m_anticipated) return;
    for (const Ridge& ridge : m_ridges)
        if (ridge.stiffness > 0.0)
            visit(Coupling{{ridge.row[0], ridge.row[1], ridge.row[2], 0},
                           {ridge.weight[0], ridge.weight[1], ridge.weight[2], 0.0},
                           ridge.normal,
                           ridge.stiffness,
                           0.0});
    for (const SelfContact& contact : m_self_contacts)
        if (contact.stiffness > 0.0 || contact.friction > 0.0)
            visit(Coupling{contact.row, contact.weight, contact.normal, contact.stiffness,
                           contact.friction});
}

}  // namespace cloth
