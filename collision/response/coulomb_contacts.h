#pragma once

#include <array>
#include <vector>

#include "data/core/types.h"

namespace cloth {

/// Contacts between pieces of cloth, each a combination of four vertices that must not come below a
/// plane, with Coulomb friction: finds the pushes p >= 0 along the normals and the rubs r across
/// them, |r| <= friction p, with which
///
///     normal . (sum of weight (y + dy)) >= height    and    sum of weight (y + dy) -> target
///     across the normal, as far as friction can.
///
/// dy is p and r times weights and inverse masses, so momentum is kept where the weights add up to
/// 0. `y` may be positions, with heights and targets in m, or velocities, in m/s. By projected
/// Gauss-Seidel, contact by contact in the order in which they were added (Jourdan, Alart and Jean,
/// "A Gauss-Seidel like algorithm to solve frictional contact problems", 1998): impulses of
/// velocities never add to the kinetic energy where heights and targets are 0. What was pushed
/// beforehand is taken back as far as it was too much.
class CoulombContacts {
 public:
    struct Contact {
        std::array<int, 4> vertex;
        std::array<double, 4> weight;  ///< 0 leaves its vertex out
        Vec3 normal;                   ///< unit
        double height = 0.0;
        Vec3 target = Vec3::Zero();
        double friction = 0.0;  ///< Coulomb's coefficient
        double push = 0.0;      ///< that is in y already
        Vec3 rub = Vec3::Zero();
    };

    /// @param inverse_masses  |V| (1/kg); a vertex of 0 never moves
    explicit CoulombContacts(VectorX inverse_masses);

    void clear() { m_contacts.clear(); }
    void add(const Contact& contact);
    size_t size() const { return m_contacts.size(); }

    /// @param sweeps  at most
    /// @param enough  a sweep in which no contact moves its point by more ends them
    /// @param y       |V| x 3
    void solve(int sweeps, double enough, Points& y);

    /// Push and rub of a contact after the last solve(), what was in y before included: mass times
    /// the unit of y.
    double push(size_t contact) const { return m_contacts[contact].push; }
    Vec3 rub(size_t contact) const { return m_contacts[contact].rub.head<3>(); }

 private:
    using Vec4 = Eigen::Vector4d;  // three coordinates in one register
    struct Solved {
        Vec4 normal, target, rub;
        std::array<double, 4> weight;
        std::array<double, 4> response;  ///< of each vertex to a push: weight / mass (1/kg)
        std::array<int, 4> vertex;
        double height, friction;
        double mobility = 0.0;  ///< how far the point moves for a push (1/kg)
        double push;
    };

    double sweep();

    VectorX m_inverse_masses;
    std::vector<Solved> m_contacts;
    std::vector<Vec4> m_y;  ///< |V|
};

}  // namespace cloth
