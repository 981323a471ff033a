#pragma once

#include <map>
#include <memory>
#include <vector>

#include "bullet_ext/bulletObstacles.h"
#include "collision/proximity/proximity.h"
#include "collision/self/layer_contacts.h"

class btSoftBody;

namespace cloth {

class SoftBodyStep;

/// Whether both ask for contact between soft bodies (VF_SS or CL_SS), as Bullet's filters allow.
bool askForContact(const btSoftBody& a, const btSoftBody& b);

/// Contact of the cloth bodies of a world with each other, whatever steppers they have: see
/// LayerContacts. Bodies that may meet in a world step are grouped before it; each is stepped as if
/// it was alone; then the contacts of each group are resolved.
///
/// A body whose cloth step does not end with the world step is not moved by the others; it is where
/// it is shown.
class ClothContacts {
 public:
    struct Member {
        btSoftBody* body;
        SoftBodyStep* step;
        long build;  ///< another number whenever `step` is another one
    };

    struct Report {
        int pairs = 0;  ///< of elements of different bodies that touch
        int left = 0;   ///< of these, that pass through each other for want of room
    };

    /// @param thickness  see LayerContactSettings
    explicit ClothContacts(double thickness) : m_thickness(thickness) {}

    /// Starts a world step of h seconds.
    void beginStep(double h);
    /// Bodies of `bodies` that may meet in the world step, as their indices, ascending, two or more
    /// in each group.
    std::vector<std::vector<size_t>> groups(const std::vector<const btSoftBody*>& bodies) const;
    /// Before SoftBodyStep::begin() of all members: tells them what contacts are expected.
    void expect(const std::vector<Member>& group);
    /// After the cloth steps of all members, before SoftBodyStep::end().
    Report resolve(const std::vector<Member>& group, BulletObstacles& obstacles);

 private:
    struct Part {
        long build;
        bool moves;
        double mass_ratio, friction;
        bool operator<(const Part& other) const;
    };
    struct Merged {
        std::vector<Eigen::Index> first;  ///< |members| + 1: of the vertices of each
        VectorX masses;                   ///< |V| (kg)
        std::unique_ptr<LayerContacts> contacts;
        std::vector<Proximity> proximity;  ///< |members|
        long used = 0;                     ///< world step of the last use
        long expected = 0;                 ///< world step of the last forecast
        double h = 0.0;                    ///< length of the last step (s)
        double debt = 0.0;                 ///< energy that could not be taken yet (J)
        Points x0, v0, x, v;
    };

    std::vector<Part> partsOf(const std::vector<Member>& group) const;
    Merged& mergedOf(const std::vector<Member>& group);
    void balance(const std::vector<Member>& group, const Points& x1, const Points& v1, bool in_air,
                 Merged& merged) const;
    void forgetUnused();

    double m_thickness;
    double m_h = 0.0;
    long m_step = 0;
    std::map<std::vector<Part>, Merged> m_merged;
};

}  // namespace cloth
