#pragma once

#include <array>
#include <unordered_map>
#include <vector>

#include "collision/proximity/proximity.h"
#include "collision/response/coulomb_contacts.h"
#include "collision/self/self_proximity.h"
#include "collision/self/self_resolve.h"

namespace cloth {

/// Pieces of cloth that are stepped each by itself, and meet.
struct LayerContactSettings {
    double thickness = 4e-3;  ///< distance that cloth keeps from cloth (m), 1e-3 to 2e-2
    int threads = 0;  ///< 0 to 1024; 0: as many as OpenMP gives; results do not depend on it
};

/// @throws ArgumentError if a setting is out of range
void check_layer_contacts(const LayerContactSettings& settings);

/// Contact between pieces of cloth, after each of them has been stepped by itself: what solver
/// moved them does not count. Layers that one solver steps together (merge_garments(), with
/// self-contact on) are the better choice where they can be chosen: there contact is part of the
/// step.
///
///     LayerContacts contacts(all, part, masses, friction, settings);
///     // each step: give forecast() / dt to the pieces as forces, step them, and then
///     contacts.resolve(x0, 5e-4, outside, x, v);
///
/// 1. What would pass through each other is put back, and elements of different pieces keep half
///    the thickness, or what they had at t, if that is less, where obstacles leave room: see
///    CoulombContacts and SelfResolver.
/// 2. The velocities get the impulses that keep elements nearer than the thickness from
///    approaching, with Coulomb's friction. Obstacles have no part in that: what presses a piece
///    against an obstacle is in its velocity, and what it is to the obstacle is found by its next
///    step.
/// 3. Of impulses that last, the next step is told beforehand: forecast(). So stiff cloth bends
///    under what lies on it within its own step, and what rests stays where it is. What was told
///    too much of is taken back by 2.
///
/// Momentum of vertices that are not pinned is kept, by positions but for obstacles, by velocities
/// and forecasts always. Cloth that meets nothing keeps its bits.
class LayerContacts {
 public:
    /// The obstacles around the pieces, at t + dt.
    class Outside {
     public:
        virtual ~Outside() = default;
        /// Brings the contacts of these vertices of x up to date (ascending), and moves those
        /// nearer to an obstacle than the distance out to it.
        /// @return  how deep the deepest of them was inside (m)
        virtual double push_out(const std::vector<int>& rows, Points& x) = 0;
        /// Nearest points of x as push_out() left it (|V|); empty: there are no obstacles.
        virtual const SurfaceContacts& contacts() const = 0;
    };

    struct Report {
        int pairs = 0;      ///< of elements that pushed each other
        int crossings = 0;  ///< that would have passed through each other all the same
        int left = 0;       ///< that still do
    };

    /// @param all       the pieces in one garment; only its mesh and its pins count
    /// @param part      |V|: piece of each vertex, from 0; faces have corners of one piece
    /// @param masses    |V| (kg), above 0
    /// @param friction  Coulomb's coefficient of each piece; of two that meet, the larger counts
    /// @throws ArgumentError if a setting is out of range
    LayerContacts(const Garment& all, std::vector<int> part, const VectorX& masses,
                  std::vector<double> friction, const LayerContactSettings& settings = {});

    /// @param x0        |V| x 3 (m): positions at t, which say what side is right
    /// @param distance  of vertices from obstacles (m) that is held
    /// @param outside   null: there are no obstacles
    /// @param x, v      |V| x 3 (m, m/s): at t + dt; those of pinned vertices do not change
    Report resolve(const Points& x0, double distance, Outside* outside, Points& x, Points& v);

    /// Impulses of contact that the next step has to expect (|V| x 3, N s), of zero sum; those of
    /// pinned vertices are what the pins have to take. If it is not given to the pieces,
    /// forget_forecast().
    /// @param scale  length of the next step over that of the last one
    const Points& forecast(double scale = 1.0);
    void forget_forecast() { m_lasting.clear(); }

 private:
    using Key = std::array<int, 3>;  // edges or not, the elements
    struct Hash {
        size_t operator()(const Key& key) const;
    };
    template <typename Value>
    using ByPair = std::unordered_map<Key, Value, Hash>;
    /// A contact that was there in two steps.
    struct Lasting {
        SelfPair pair;
        double push;  ///< (N s)
        Vec3 rub;     ///< (N s)
    };

    static Key key_of(const SelfPair& pair);
    double friction_of(const SelfPair& pair) const;
    CoulombContacts::Contact contact_of(const SelfPair& pair) const;
    void separate(const Points& x0, double distance, const SurfaceContacts& outside, Points& x);
    void sort_rows();
    int slow_down(Points& v);
    void remember();

    LayerContactSettings m_settings;
    std::vector<int> m_part;
    std::vector<double> m_friction;
    SelfProximity m_proximity;
    SelfResolver m_resolver;
    CoulombContacts m_contacts;
    SurfaceContacts m_none;
    std::vector<SelfPair> m_touching;  ///< in this step, some twice
    std::vector<Lasting> m_lasting;    ///< in the forecast of this step, then of the next one
    ByPair<double> m_pushes;           ///< of the last step (N s), those above 0
    ByPair<size_t> m_index;            ///< of the contacts of the velocities
    std::vector<int> m_rows;
    Points m_forecast;
};

}  // namespace cloth
