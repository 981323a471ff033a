#include "collision/proximity/limb_overlap.h"

#include <algorithm>
#include <utility>

#include "collision/geometry/select_rows.h"
#include "data/core/check_range.h"

namespace cloth {
namespace {

// m: limbs are open where they are joined, so a point outside of the box may count as inside
constexpr double around_limbs = 0.02;
constexpr int enough_rows = 1000;  // to be worth waking threads for

LimbSet only(size_t limb) {
    return LimbSet(1) << limb;
}

}  // namespace

LimbOverlap::LimbOverlap(const LimbOverlapSettings& settings,
                         const std::shared_ptr<ObstacleTrees>& trees, Proximity* searches)
    : m_settings(settings),
      m_proximity({}, trees),
      m_own_proximity({}, trees),
      m_other_proximity({}, trees),
      m_searches(searches && searches->settings().radius >= settings.reach ? searches : nullptr) {
    check_range("LimbOverlapSettings.reach", settings.reach, 0.01, 0.1);
    check_range("LimbOverlapSettings.margin", settings.margin, 1e-3, 0.05);
    check_range("LimbOverlapSettings.least_cover", settings.least_cover, 0.0, 0.2);
    check_range("LimbOverlapSettings.pinch_cover", settings.pinch_cover, 0.0, 0.2);
    check_range("LimbOverlapSettings.layer_room", settings.layer_room, 0.0, 0.1);
}

/// Returns whether any obstacle has limbs that are told apart. What is remembered of obstacles that
/// are still there stays; others may come and go.
bool LimbOverlap::learn_limbs(const Boundary& boundary, const Points& x) {
    find_skins(boundary);
    m_others.clear();
    if (!are_those_of_last_step()) {
        for (const Skin& skin : m_found) m_others.push_back(skin.obstacle);
        choose_character(boundary, x);
        replace_skins(boundary);
    }
    m_known.swap(m_found);
    m_is_known.assign(boundary.obstacles.size(), 0);
    for (const Skin& skin : m_known) m_is_known[skin.obstacle] = 1;
    m_others.erase(std::remove_if(m_others.begin(), m_others.end(),
                                  [&](size_t k) { return m_is_known[k] != 0; }),
                   m_others.end());
    return !m_known.empty();
}

void LimbOverlap::find_skins(const Boundary& boundary) {
    m_found.clear();
    for (size_t k = 0; k < boundary.obstacles.size(); ++k) {
        const Obstacle& obstacle = boundary.obstacles[k];
        if (obstacle.is_whole || !has_limbs(obstacle)) continue;
        Skin skin;
        skin.faces = obstacle.faces;
        skin.limbs = obstacle.limbs;
        skin.id = obstacle.id;
        skin.obstacle = k;
        for (const Skin& other : m_found) skin.occurrence += other.is_like(skin) ? 1 : 0;
        m_found.push_back(std::move(skin));
    }
}

/// Takes over what is known of the skins in m_found.
bool LimbOverlap::are_those_of_last_step() {
    size_t count = 0;
    for (Skin& skin : m_found)
        for (const Skin& known : m_known) {
            if (!known.is(skin)) continue;
            skin.numbers = known.numbers;
            skin.is_known = true;
            ++count;
        }
    return count == m_found.size() && count == m_known.size();
}

LimbSet LimbOverlap::shared_numbers() const {
    LimbSet once = 0, twice = 0;
    for (const Skin& skin : m_found) {
        twice |= once & skin.numbers;
        once |= skin.numbers;
    }
    return twice;
}

/// Leaves in m_found one of the skins that have a number in common: that of the vertices' own
/// limbs, or else the one that most vertices are near, if any is.
void LimbOverlap::choose_character(const Boundary& boundary, const Points& x) {
    for (Skin& skin : m_found)
        if (!skin.is_known)
            for (const std::uint8_t limb : *skin.limbs) skin.numbers |= only(limb);
    if (shared_numbers() == 0) return;
    LimbSet owned = 0, taken = 0;
    for (const LimbSet limb : m_own) owned |= limb;
    const auto is_own = [&](const Skin& skin) {
        return skin.is_known && (skin.numbers & owned) != 0;
    };
    for (const Skin& skin : m_found)
        if (is_own(skin)) taken |= skin.numbers;
    const auto is_another = [&](const Skin& skin) {
        return !is_own(skin) && (skin.numbers & taken) != 0;
    };
    m_found.erase(std::remove_if(m_found.begin(), m_found.end(), is_another), m_found.end());
    const LimbSet shared = shared_numbers();
    if (shared == 0) return;
    count_near(boundary, x);
    std::stable_sort(m_found.begin(), m_found.end(),
                     [](const Skin& a, const Skin& b) { return a.near > b.near; });
    std::vector<Skin> chosen;
    taken = 0;
    for (Skin& skin : m_found) {
        if ((skin.numbers & taken) != 0 || (skin.near == 0 && (skin.numbers & shared) != 0))
            continue;
        taken |= skin.numbers;
        chosen.push_back(std::move(skin));
    }
    m_found.swap(chosen);
}

void LimbOverlap::count_near(const Boundary& boundary, const Points& x) {
    m_proximity.query(x, boundary, m_near);
    for (Skin& skin : m_found)
        skin.near = static_cast<int>(std::count(m_near.obstacle.begin(), m_near.obstacle.end(),
                                                static_cast<int>(skin.obstacle)));
}

/// Forgets the skins in m_known that are not in m_found any more, and learns the new ones.
void LimbOverlap::replace_skins(const Boundary& boundary) {
    LimbSet lost = 0;
    bool any_stays = false;
    for (const Skin& known : m_known) {
        const bool stays = std::any_of(m_found.begin(), m_found.end(),
                                       [&](const Skin& skin) { return skin.is(known); });
        if (!stays) lost |= known.numbers;
        any_stays = any_stays || stays;
    }
    forget(lost);
    if (!any_stays) m_own.clear();
    for (const Skin& skin : m_found)
        if (!skin.is_known) add_joints(boundary.obstacles[skin.obstacle]);
}

void LimbOverlap::forget(LimbSet limbs) {
    if (limbs == 0) return;
    m_covered &= ~limbs;
    for (size_t limb = 0; limb < max_limbs; ++limb)
        if ((limbs & only(limb)) != 0) m_joined[limb] = 0;
    for (size_t i = 0; i < m_own.size(); ++i) {
        m_ignored[i] &= ~limbs;
        if ((m_own[i] & limbs) != 0) m_own[i] = m_unjoined[i] = m_passed[i] = 0;
    }
}

/// The boundary as it is for the limbs: other characters must not hide them, nor be taken for them.
const Boundary& LimbOverlap::without_others(const Boundary& boundary) {
    m_has_limbs = m_is_known;
    if (m_others.empty()) return boundary;
    m_seen.trees = boundary.trees;
    m_seen.obstacles.resize(boundary.obstacles.size() - m_others.size());
    size_t seen = 0;
    for (size_t k = 0; k < boundary.obstacles.size(); ++k) {
        if (std::binary_search(m_others.begin(), m_others.end(), k)) continue;
        m_seen.obstacles[seen] = boundary.obstacles[k];
        m_has_limbs[seen++] = m_is_known[k];
    }
    m_has_limbs.resize(seen);
    return m_seen;
}

/// Limbs are joined where their faces share a vertex.
void LimbOverlap::add_joints(const Obstacle& obstacle) {
    const Faces& faces = *obstacle.faces;
    std::vector<LimbSet> at_vertex(static_cast<size_t>(obstacle.x0.rows()), 0);
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int k = 0; k < 3; ++k)
            if (faces(f, k) >= 0 && faces(f, k) < obstacle.x0.rows())
                at_vertex[static_cast<size_t>(faces(f, k))] |=
                    only((*obstacle.limbs)[static_cast<size_t>(f)]);
    for (const LimbSet meeting : at_vertex)
        for (size_t limb = 0; limb < max_limbs; ++limb)
            if ((meeting & only(limb)) != 0) m_joined[limb] |= meeting;
}

/// To a single limb, itself among them.
LimbSet LimbOverlap::joined(LimbSet limb) const {
    for (size_t k = 0; k < max_limbs; ++k)
        if (limb == only(k)) return m_joined[k];
    return 0;
}

LimbSet LimbOverlap::limb_at(const Boundary& boundary, int obstacle, int face) const {
    const auto k = static_cast<size_t>(obstacle);
    if (obstacle < 0 || face < 0 || !m_has_limbs[k]) return 0;
    return only((*boundary.obstacles[k].limbs)[static_cast<size_t>(face)]);
}

LimbSet LimbOverlap::limb_of(const Boundary& boundary, int vertex) const {
    const auto i = static_cast<size_t>(vertex);
    return limb_at(boundary, m_near.obstacle[i], m_near.face[i]);
}

void LimbOverlap::find_own_limbs(const Boundary& boundary, const Points& x) {
    const auto count = static_cast<size_t>(x.rows());
    if (m_own.size() != count) {
        m_own.assign(count, 0);
        m_unjoined.assign(count, 0);
        m_ignored.assign(count, 0);
        m_without.assign(count, 0);
        m_passed.assign(count, 0);
        m_pinched.assign(count, 0);
        m_found_joined.assign(count, 0);
        for (std::vector<int>* rows : {&m_rows, &m_next, &m_uncovered}) rows->reserve(count);
        m_deep.reserve(count);
        m_covers.reserve(count);
        m_proximity.query(x, boundary, m_near);
        m_near_own = m_near;
    }
    m_rows.clear();
    for (size_t i = 0; i < count; ++i)
        if (m_own[i] == 0) m_rows.push_back(static_cast<int>(i)), m_without[i] = 0;
    if (m_rows.empty()) return;
    m_proximity.query_rows(x, m_rows, boundary, m_near, StepEnd::start, {&m_without});
    for (const int i : m_rows) {
        const auto vertex = static_cast<size_t>(i);
        m_own[vertex] = limb_of(boundary, i);
        for (size_t limb = 0; limb < max_limbs; ++limb)
            if (m_own[vertex] == only(limb)) m_unjoined[vertex] = ~m_joined[limb];
        m_passed[vertex] = m_own[vertex] | m_unjoined[vertex];
    }
}

/// Whether the vertex is outside of the limb in m_near, with room between limb and own limb.
bool LimbOverlap::is_clear(int vertex, LimbSet limb, StepEnd end) {
    if (m_near.distance[vertex] > m_settings.reach) return true;
    if (m_near.distance[vertex] < m_settings.margin) return false;
    const bool folded = (m_unjoined[static_cast<size_t>(vertex)] & limb) == 0;
    const LimbSet own = folded ? limb : joined(limb);
    if (m_proximity.cover(m_near, vertex, end, own)) return false;
    if (!m_near_own.has(vertex)) return true;
    const bool start = end == StepEnd::start;
    const Vec3 own_point = (start ? m_near_own.point0 : m_near_own.point1).row(vertex);
    const Vec3 point = (start ? m_near.point0 : m_near.point1).row(vertex);
    return (own_point - point).dot((start ? m_near.normal0 : m_near.normal1).row(vertex)) > 0.0;
}

/// Marks those of the limbs that are not clear of vertices which ignore them.
void LimbOverlap::keep(const Boundary& boundary, const Points& x, StepEnd end, LimbSet limbs) {
    for (size_t limb = 0; limb < max_limbs; ++limb) {
        if ((limbs & only(limb)) == 0) continue;
        m_rows.clear();
        for (const int i : m_next) {
            const auto vertex = static_cast<size_t>(i);
            if ((m_ignored[vertex] & ~m_keep[vertex] & only(limb)) == 0) continue;
            m_rows.push_back(i);
            m_without[vertex] = ~only(limb);
        }
        if (m_rows.empty()) continue;
        m_proximity.query_rows(x, m_rows, boundary, m_near, end, {&m_without});
        for (const int i : m_rows)
            if (m_near.has(i) && !is_clear(i, only(limb), end))
                m_keep[static_cast<size_t>(i)] |= only(limb);
    }
}

LimbSet LimbOverlap::ignored_by_any() const {
    LimbSet any = 0;
    for (const LimbSet limbs : m_ignored) any |= limbs;
    return any;
}

/// Lets vertices touch what they are clear of, at both ends; m_near_own is to be of the start.
void LimbOverlap::release(const Boundary& boundary, const Points& x0, const Points& x1) {
    const LimbSet limbs = ignored_by_any();
    if (limbs == 0) return;
    m_keep.assign(m_own.size(), 0);
    m_next.clear();
    for (size_t i = 0; i < m_own.size(); ++i)
        if (m_ignored[i] != 0) m_next.push_back(static_cast<int>(i));
    keep(boundary, x0, StepEnd::start, limbs);
    keep(boundary, x1, StepEnd::end, limbs);
    LimbSet kept = 0;
    for (size_t i = 0; i < m_own.size(); ++i) {
        m_ignored[i] &= m_keep[i];
        kept |= m_keep[i];
    }
    m_covered &= kept;
}

/// Puts the vertices that have a limb of their own into m_rows.
void LimbOverlap::select_owners() {
    m_rows.clear();
    for (size_t i = 0; i < m_own.size(); ++i)
        if (m_own[i] != 0) m_rows.push_back(static_cast<int>(i));
}

/// Those of them that are within reach (m) of the box of a limb that they do not pass over.
void LimbOverlap::select_near(const Points& x, double reach, const std::vector<LimbSet>& passed) {
    const auto is_near = [&](int i) {
        const auto vertex = static_cast<size_t>(i);
        return m_own[vertex] != 0 && (m_boxes.near(x.row(i), reach) & ~passed[vertex]) != 0;
    };
    select_rows(0, static_cast<int>(m_own.size()), enough_rows, m_wanted, m_rows, is_near);
}

/// The limbs in whose boxes there may be something over the surface point of a row. The boxes are
/// those of this end.
LimbSet LimbOverlap::above(const SurfaceContacts& contacts, int row, StepEnd end) const {
    const bool start = end == StepEnd::start;
    return m_boxes.along((start ? contacts.point0 : contacts.point1).row(row),
                         (start ? contacts.normal0 : contacts.normal1).row(row), Cover::farthest);
}

/// Looks at the limbs within reach of each vertex, one after the other, for skin inside another.
void LimbOverlap::find_covered(const Boundary& boundary, const Points& x, StepEnd end) {
    for (size_t i = 0; i < m_own.size(); ++i) m_without[i] = ~m_unjoined[i] | m_ignored[i];
    select_near(x, m_settings.reach, m_without);
    for (Proximity* searches = &m_other_proximity; !m_rows.empty(); searches = &m_proximity) {
        searches->query_rows(x, m_rows, boundary, m_near, end, {&m_without, m_settings.reach});
        pass_over_found(boundary);
        mark_covered(boundary, end);
    }
}

/// Keeps the rows for which a limb was found, to be passed over from now on.
void LimbOverlap::pass_over_found(const Boundary& boundary) {
    m_next.clear();
    for (const int i : m_rows) {
        const auto vertex = static_cast<size_t>(i);
        const LimbSet limb = limb_of(boundary, i) & ~m_without[vertex];
        if (limb == 0) continue;
        m_without[vertex] |= limb;
        m_found_joined[vertex] = joined(limb);
        m_next.push_back(i);
    }
    m_rows.swap(m_next);
}

/// Marks the limbs whose skin in m_near is inside another limb. Those that are known to be covered
/// are not looked at, nor is skin over which there is no box.
void LimbOverlap::mark_covered(const Boundary& boundary, StepEnd end) {
    m_uncovered = m_rows;
    keep_rows(enough_rows, m_wanted, m_uncovered, [&](int i) {
        return (limb_of(boundary, i) & ~m_covered) != 0 &&
               (above(m_near, i, end) & ~m_found_joined[static_cast<size_t>(i)]) != 0;
    });
    if (m_uncovered.empty()) return;
    m_proximity.cover_rows(boundary, m_near, m_uncovered, end, m_found_joined, m_covers);
    for (size_t k = 0; k < m_uncovered.size(); ++k)
        if (m_covers[k]) m_covered |= limb_of(boundary, m_uncovered[k]);
}

void LimbOverlap::ignore_covered() {
    if (m_covered == 0) return;
    for (size_t i = 0; i < m_own.size(); ++i) m_ignored[i] |= m_covered & m_unjoined[i];
}

/// Finds the skin of their own limbs that is nearest to the vertices in m_rows.
void LimbOverlap::find_own_skin(Proximity& searches, const Boundary& boundary, const Points& x,
                                StepEnd end) {
    for (const int i : m_rows) m_without[static_cast<size_t>(i)] = ~m_own[static_cast<size_t>(i)];
    searches.query_rows(x, m_rows, boundary, m_near_own, end, {&m_without, m_settings.reach});
}

/// Finds what lies over that skin of limbs that are joined to it; rows where that cannot be are
/// dropped.
void LimbOverlap::find_covers(const Boundary& boundary, StepEnd end) {
    keep_rows(enough_rows, m_wanted, m_rows, [&](int i) {
        return m_near_own.has(i) &&
               (above(m_near_own, i, end) & ~m_passed[static_cast<size_t>(i)]) != 0;
    });
    m_proximity.cover_rows(boundary, m_near_own, m_rows, end, m_passed, m_covers);
}

void LimbOverlap::ignore_folded_at_start(const Boundary& boundary, const Points& x) {
    select_owners();
    find_own_skin(m_searches ? *m_searches : m_own_proximity, boundary, x, StepEnd::start);
    find_covers(boundary, StepEnd::start);
    ignore_folded(boundary, x, StepEnd::start);
}

/// What is not in the box of a joined limb is not inside the limb.
void LimbOverlap::ignore_folded_at_end(const Boundary& boundary, const Points& x) {
    select_near(x, around_limbs, m_passed);
    find_own_skin(m_own_proximity, boundary, x, StepEnd::end);
    find_covers(boundary, StepEnd::end);
    ignore_folded(boundary, x, StepEnd::end);
}

/// Lets vertices in m_rows that are inside a joined limb ignore it where it lies over their own
/// limb's skin: deep in the fold, it pinches them.
void LimbOverlap::ignore_folded(const Boundary& boundary, const Points& x, StepEnd end) {
    m_next.clear();
    m_deep.clear();
    for (size_t k = 0; k < m_rows.size(); ++k) {
        const int i = m_rows[k];
        const auto vertex = static_cast<size_t>(i);
        const auto& cover = m_covers[k];
        if (cover && marks_overlapped()) m_overlapped[vertex] = 1;
        if (!cover || !(cover->depth > m_settings.least_cover)) continue;
        m_without[vertex] = ~limb_at(boundary, m_near_own.obstacle[vertex], cover->face);
        m_next.push_back(i);
        m_deep.push_back(cover->depth >= m_settings.pinch_cover ? 1 : 0);
    }
    m_proximity.query_rows(x, m_next, boundary, m_near, end, {&m_without});
    for (size_t k = 0; k < m_next.size(); ++k) {
        const int i = m_next[k];
        const auto vertex = static_cast<size_t>(i);
        if (m_near.has(i) && m_near.distance[i] > 0.0) continue;
        m_ignored[vertex] |= ~m_without[vertex];
        m_pinched[vertex] |= m_deep[k];
    }
}

/// Returns whether there is anything to tell. @param boundary  without_others()
bool LimbOverlap::find_ignored(const Boundary& boundary, double dt, const ClothState& state) {
    find_own_limbs(boundary, state.x);
    std::fill(m_pinched.begin(), m_pinched.end(), 0);
    if (marks_overlapped()) m_overlapped.resize(m_own.size(), 0);
    m_x = state.x + dt * state.v;
    m_boxes.fit(boundary, m_has_limbs, StepEnd::start);
    find_covered(boundary, state.x, StepEnd::start);  // all starts before the ends: one refit
    ignore_covered();
    ignore_folded_at_start(boundary, state.x);
    release(boundary, state.x, m_x);
    mark_overlapped(boundary, state.x, StepEnd::start);
    m_boxes.fit(boundary, m_has_limbs, StepEnd::end);
    ignore_folded_at_end(boundary, m_x);
    find_covered(boundary, m_x, StepEnd::end);
    ignore_covered();
    mark_overlapped(boundary, m_x, StepEnd::end);
    const auto is_marked = [](char mark) { return mark != 0; };
    return !ignores_nothing() || std::any_of(m_overlapped.begin(), m_overlapped.end(), is_marked);
}

const Boundary& LimbOverlap::filter(const Boundary& boundary, double dt, const ClothState& state) {
    if (!learn_limbs(boundary, state.x)) {
        m_own.clear();
        m_ignored.clear();
        return boundary;
    }
    m_overlapped = boundary.overlapped;
    if (!find_ignored(without_others(boundary), dt, state)) return boundary;
    m_boundary = boundary;
    for (size_t k = 0; k < m_is_known.size(); ++k)
        if (m_boundary.obstacles[k].shape == ObstacleShape::mesh && !m_is_known[k])
            m_boundary.obstacles[k].is_whole = true;
    m_boundary.overlapped = m_overlapped;
    m_boundary.ignored_limbs = m_ignored;
    m_boundary.pinched = m_pinched;
    for (size_t i = 0; i < m_own.size(); ++i) {
        m_boundary.ignored_limbs[i] |= ignored_limbs(boundary, static_cast<int>(i));
        m_boundary.pinched[i] |= is_pinched(boundary, static_cast<Eigen::Index>(i)) ? 1 : 0;
    }
    return m_boundary;
}

/// Puts the vertices that ignore the limb into m_rows, to be asked for it and what is joined to it:
/// past the end of a limb, the next one is nearer.
void LimbOverlap::select_inside_candidates(LimbSet limb, const std::vector<char>& left_out) {
    m_rows.clear();
    for (size_t i = 0; i < m_ignored.size(); ++i) {
        if ((m_ignored[i] & limb) == 0 || (i < left_out.size() && left_out[i])) continue;
        m_rows.push_back(static_cast<int>(i));
        m_without[i] = ~(joined(limb) & ~m_own[i]);
    }
}

/// Marks where cloth passes through cloth. The boxes are those of this end.
void LimbOverlap::mark_overlapped(const Boundary& boundary, const Points& x, StepEnd end) {
    if (!marks_overlapped()) return;
    const LimbSet ignored = ignored_by_any();
    for (size_t limb = 0; limb < max_limbs; ++limb)
        if ((ignored & only(limb)) != 0) mark_inside(boundary, x, end, only(limb));
    mark_squeezed(boundary, x, end);
}

/// Vertices that are in a limb that they ignore, or no farther from it than those that still do.
void LimbOverlap::mark_inside(const Boundary& boundary, const Points& x, StepEnd end,
                              LimbSet limb) {
    select_inside_candidates(limb, m_overlapped);
    keep_rows(enough_rows, m_wanted, m_rows,
              [&](int i) { return (m_boxes.near(x.row(i), m_settings.margin) & limb) != 0; });
    m_proximity.query_rows(x, m_rows, boundary, m_near, end, {&m_without});
    for (const int i : m_rows)
        if (limb_of(boundary, i) == limb && m_near.distance[i] < m_settings.margin)
            m_overlapped[static_cast<size_t>(i)] = 1;
}

/// Vertices between their own limb's skin and another that faces it, without room for layers.
void LimbOverlap::mark_squeezed(const Boundary& boundary, const Points& x, StepEnd end) {
    constexpr double facing = -0.5;  // cosine between the normals of skins that face each other
    const double room = m_settings.layer_room;
    select_near(x, room, m_own);
    find_own_skin(m_own_proximity, boundary, x, end);
    for (const int i : m_rows) m_without[static_cast<size_t>(i)] = m_own[static_cast<size_t>(i)];
    m_other_proximity.query_rows(x, m_rows, boundary, m_near, end, {&m_without, room});
    const bool start = end == StepEnd::start;
    const Points& normals = start ? m_near.normal0 : m_near.normal1;
    const Points& own_normals = start ? m_near_own.normal0 : m_near_own.normal1;
    for (const int i : m_rows)
        if (m_near.has(i) && m_near_own.has(i) &&
            m_near.distance[i] + m_near_own.distance[i] < room &&
            normals.row(i).dot(own_normals.row(i)) < facing)
            m_overlapped[static_cast<size_t>(i)] = 1;
}

IgnoredDepth LimbOverlap::measure_ignored(const Points& x, const std::vector<char>& left_out) {
    if (ignores_nothing() || static_cast<size_t>(x.rows()) != m_ignored.size()) return {};
    // Of several obstacles the deepest answers: the others must not hide the limbs.
    const auto other = [](const Obstacle& obstacle) {
        return obstacle.is_whole || !has_limbs(obstacle);
    };
    std::vector<Obstacle>& obstacles = m_boundary.obstacles;
    obstacles.erase(std::remove_if(obstacles.begin(), obstacles.end(), other), obstacles.end());
    m_has_limbs.assign(obstacles.size(), 1);
    m_depth = VectorX::Zero(x.rows());
    const LimbSet ignored = ignored_by_any();
    for (size_t limb = 0; limb < max_limbs; ++limb) {
        if ((ignored & only(limb)) == 0) continue;
        select_inside_candidates(only(limb), left_out);
        if (m_rows.empty()) continue;
        m_proximity.query_rows(x, m_rows, m_boundary, m_near, StepEnd::end, {&m_without});
        for (const int i : m_rows)
            if (limb_of(m_boundary, i) == only(limb))
                m_depth[i] = std::max(m_depth[i], -m_near.distance[i]);
    }
    return {static_cast<int>((m_depth.array() > 0.0).count()), m_depth.maxCoeff()};
}

}  // namespace cloth
