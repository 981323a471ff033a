#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "collision/proximity/limb_boxes.h"
#include "collision/proximity/proximity.h"
#include "data/core/cloth_state.h"

namespace cloth {

struct LimbOverlapSettings {
    double reach = 0.05;   ///< limbs farther from a vertex (m) are not looked at, 0.01 to 0.1
    double margin = 0.01;  ///< a limb that was ignored is touched again when it is clear of the
                           ///< vertex by this (m), 1e-3 to 0.05
    double least_cover = 0.01;  ///< of a joined limb (m) over the skin of a vertex's own limb, for
                                ///< it to be ignored, 0 to 0.2
    double pinch_cover = 0.04;  ///< from which on (m) the two pinch the vertex, 0 to 0.2: where
                                ///< they only just meet, cloth that is held tears
    double layer_room = 0.0;    ///< that two layers of cloth need between skins (m), 0 to 0.1:
                                ///< where there is less of it, Boundary::overlapped is set. 0:
                                ///< nowhere, which costs nothing
};

/// How far cloth is inside limbs that it ignores.
struct IgnoredDepth {
    int vertices = 0;    ///< that are inside a limb that they ignore
    double depth = 0.0;  ///< of the deepest of them (m)
};

/// Contact with a body whose limbs pass through each other, as those of motion that was captured
/// on another body do. Where a limb's skin lies inside another limb there is no room for cloth: it
/// is pushed out of one into the other, ends on the wrong side of the thinner one, and is dragged
/// along when they part. So there cloth keeps to the limb that it belongs to:
///
/// - A vertex belongs to the limb that it first came near: its own limb.
/// - A limb is covered while its skin near the cloth lies inside another one that is not joined to
///   it, and until the cloth has come clear of it. Cloth that belongs neither to it nor to a limb
///   that is joined to it ignores it.
/// - Limbs that are joined always meet, as in an armpit. There a vertex that has come inside
///   the other limb ignores it where it lies over its own limb's skin, until it is clear of it.
///   While it is inside, and deep in the fold, the two pinch it: without friction that holds it
///   there, it slips over the end of its own limb, and the arm is out of its sleeve.
/// - Where skins overlap, or leave less room than layers of cloth need, these cannot all stay on
///   their own skins and apart: Boundary::overlapped says so, if the settings ask for it.
///
///     LimbOverlap limbs;
///     const Boundary& outside = limbs.filter(boundary, dt, state);  // in every step
///
/// Obstacles with limbs of different numbers, such as a body and its hands, are one character. Of
/// several that have a number in common, cloth keeps to the one that its vertices belong to, or
/// that most of them are near. The others are other characters: they are touched everywhere
/// (Obstacle::is_whole), and what they do nearby changes nothing for the limbs of the first.
///
/// Costs nothing where no obstacle has limbs. What it decides depends on the steps before, as long
/// as the character stays near.
class LimbOverlap {
 public:
    /// @param trees     see Proximity
    /// @param searches  asked for the vertices' own limbs at the start of a step: of whoever asks
    ///                  for their nearest points then, so that few are searched for twice. Null:
    ///                  its own
    /// @throws ArgumentError if a setting is out of range
    explicit LimbOverlap(const LimbOverlapSettings& settings = {},
                         const std::shared_ptr<ObstacleTrees>& trees = nullptr,
                         Proximity* searches = nullptr);

    /// The boundary with the limbs that are ignored in the step that begins added to
    /// Boundary::ignored_limbs, what is pinched in Boundary::pinched, and Boundary::overlapped if
    /// the settings ask for it; itself, if there is nothing to add. It is valid until the next
    /// call.
    const Boundary& filter(const Boundary& boundary, double dt, const ClothState& state);

    /// How far the vertices are inside limbs that they ignored in the last step, at its end. What
    /// is deeper than Proximity looks (0.1 m) is not seen. Costs nothing where none is ignored.
    /// @param x         positions after that step (|V| x 3, m)
    /// @param left_out  vertices that do not count, such as pins (|V|), or empty
    IgnoredDepth measure_ignored(const Points& x, const std::vector<char>& left_out = {});

    /// The limbs that each vertex ignores in the last step (|V|), or empty.
    const std::vector<LimbSet>& ignored() const { return m_ignored; }

 private:
    /// An obstacle with limbs. The pointers are held, so that they stay keys.
    struct Skin {
        std::shared_ptr<const Faces> faces;
        std::shared_ptr<const std::vector<std::uint8_t>> limbs;
        int id = 0;             ///< Obstacle::id
        int occurrence = 0;     ///< among those that are alike in all of this
        size_t obstacle = 0;    ///< in the boundary of this step
        LimbSet numbers = 0;    ///< of its limbs
        bool is_known = false;  ///< it was told apart in the last step
        int near = 0;           ///< vertices, where that was asked for

        bool is_like(const Skin& other) const {
            return id == other.id && faces == other.faces && limbs == other.limbs;
        }
        bool is(const Skin& other) const {
            return is_like(other) && occurrence == other.occurrence;
        }
    };

    bool learn_limbs(const Boundary& boundary, const Points& x);
    void find_skins(const Boundary& boundary);
    bool are_those_of_last_step();
    void choose_character(const Boundary& boundary, const Points& x);
    void count_near(const Boundary& boundary, const Points& x);
    LimbSet shared_numbers() const;
    void replace_skins(const Boundary& boundary);
    void forget(LimbSet limbs);
    const Boundary& without_others(const Boundary& boundary);
    bool find_ignored(const Boundary& boundary, double dt, const ClothState& state);
    void add_joints(const Obstacle& obstacle);
    void find_own_limbs(const Boundary& boundary, const Points& x);
    void release(const Boundary& boundary, const Points& x0, const Points& x1);
    void keep(const Boundary& boundary, const Points& x, StepEnd end, LimbSet limbs);
    bool is_clear(int vertex, LimbSet limb, StepEnd end);
    void find_covered(const Boundary& boundary, const Points& x, StepEnd end);
    void pass_over_found(const Boundary& boundary);
    void mark_covered(const Boundary& boundary, StepEnd end);
    void ignore_covered();
    void select_owners();
    void select_near(const Points& x, double reach, const std::vector<LimbSet>& passed);
    void find_own_skin(Proximity& searches, const Boundary& boundary, const Points& x, StepEnd end);
    void find_covers(const Boundary& boundary, StepEnd end);
    void ignore_folded_at_start(const Boundary& boundary, const Points& x);
    void ignore_folded_at_end(const Boundary& boundary, const Points& x);
    void ignore_folded(const Boundary& boundary, const Points& x, StepEnd end);
    bool marks_overlapped() const { return m_settings.layer_room > 0.0; }
    void mark_overlapped(const Boundary& boundary, const Points& x, StepEnd end);
    void mark_inside(const Boundary& boundary, const Points& x, StepEnd end, LimbSet limb);
    void mark_squeezed(const Boundary& boundary, const Points& x, StepEnd end);
    LimbSet above(const SurfaceContacts& contacts, int row, StepEnd end) const;
    LimbSet ignored_by_any() const;
    bool ignores_nothing() const { return ignored_by_any() == 0; }
    void select_inside_candidates(LimbSet limb, const std::vector<char>& left_out);
    LimbSet joined(LimbSet limb) const;
    LimbSet limb_at(const Boundary& boundary, int obstacle, int face) const;
    LimbSet limb_of(const Boundary& boundary, int vertex) const;

    LimbOverlapSettings m_settings;
    Proximity m_proximity;
    // Searches begin at the faces found last, so each kind has its own.
    Proximity m_own_proximity;      ///< of own limbs
    Proximity m_other_proximity;    ///< of the nearest limb that is not joined to the own one
    Proximity* m_searches;          ///< used instead of m_own_proximity at the start; or null
    std::vector<char> m_has_limbs;  ///< each obstacle that is looked at; see without_others()
    std::vector<char> m_is_known;   ///< each obstacle of the last step: of the character
    std::vector<Skin> m_known;      ///< of the character in the last step
    std::vector<Skin> m_found;      ///< scratch memory
    std::vector<size_t> m_others;   ///< obstacles that are other characters, ascending
    Boundary m_seen;                ///< without them, if there are any
    std::array<LimbSet, max_limbs> m_joined = {};  ///< to each limb, itself among them
    LimbBoxes m_boxes;                             ///< at the end that is looked at
    LimbSet m_covered = 0;
    std::vector<LimbSet> m_own;       ///< |V|: 0: has not come near any limb yet
    std::vector<LimbSet> m_unjoined;  ///< |V|: limbs not joined to its own; 0: it has no own limb
    std::vector<LimbSet> m_ignored;   ///< |V|
    std::vector<char> m_pinched;      ///< |V|: in this step
    std::vector<char> m_overlapped;   ///< |V|: in this step; empty: it is not looked for
    std::vector<char> m_deep;         ///< of m_next: deep enough in the fold to be pinched
    std::vector<LimbSet> m_keep;      ///< |V|: limbs that are not clear of the vertex
    std::vector<LimbSet> m_without;   ///< |V|: limbs that a query passes over
    std::vector<LimbSet> m_passed;    ///< |V|: limbs that do not cover the vertex's own
    std::vector<LimbSet> m_found_joined;  ///< |V|: limbs that are joined to the one in m_near
    std::vector<std::optional<Cover>> m_covers;  ///< over the own limbs of m_rows
    SurfaceContacts m_near, m_near_own;
    std::vector<int> m_rows, m_next, m_uncovered;
    std::vector<char> m_wanted;  ///< scratch memory
    VectorX m_depth;             ///< |V| (m): inside limbs that are ignored
    Points m_x;                  ///< |V| x 3 (m): where the vertices are heading
    Boundary m_boundary;         ///< of the last step, if any vertex ignored a limb
};

}  // namespace cloth
