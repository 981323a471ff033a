#include "bullet_ext/animatedObstacle.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "data/core/mesh_orientation.h"

namespace cloth {

namespace {

/// Programs that skin in single precision, or reckon times by themselves, do not hit the pose of
/// before exactly.
constexpr double kSamePlace = 1e-4;  // m
constexpr double kSameTime = 1e-6;   // of the duration

AnimatedObstacle::Box boxAround(const Points& x) {
    return {x.colwise().minCoeff(), x.colwise().maxCoeff()};
}

AnimatedObstacle::Box boxAroundBoth(const AnimatedObstacle::Box& a,
                                    const AnimatedObstacle::Box& b) {
    return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)};
}

/// Squared distances (m^2) between the vertices of two poses.
struct PoseGap {
    double mean = 0.0, largest = 0.0;
};

PoseGap gapBetween(const Points& a, const Points& b) {
    PoseGap gap;
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
        const double square = (a.row(i) - b.row(i)).squaredNorm();
        gap.mean += square;
        gap.largest = std::max(gap.largest, square);
    }
    gap.mean /= static_cast<double>(a.rows());
    return gap;
}

bool isApart(const PoseGap& gap) {
    return gap.largest > kSamePlace * kSamePlace;
}

bool areEqual(const Faces& a, const Faces& b) {
    return a.rows() == b.rows() && a == b;
}

bool areEqual(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    return a == b;
}

template <typename T>
void keepIfEqual(const std::shared_ptr<const T>& known, std::shared_ptr<const T>& given) {
    if (given != known && given && known && areEqual(*given, *known)) given = known;
}

}  // namespace

bool AnimatedObstacle::Box::overlaps(const Vec3& other_low, const Vec3& other_high) const {
    return (low.array() <= other_high.array()).all() && (high.array() >= other_low.array()).all();
}

void AnimatedObstacle::give(AnimatedMesh mesh, bool is_in_world) {
    keepPointers(mesh);
    if (m_end > 0.0) rememberPose();
    m_mesh = std::move(mesh);
    m_begin = m_end = 0.0;
    m_from_last = m_stands = false;
    m_was_in_world = m_was_in_world || is_in_world;
}

void AnimatedObstacle::keepPointers(AnimatedMesh& mesh) {
    constexpr int kFew = 8;  // changes of the level of detail are not as many in a row
    const bool is_first = !m_mesh.faces;
    keepIfEqual(m_mesh.faces, mesh.faces);
    keepIfEqual(m_mesh.limbs, mesh.limbs);
    const bool has_other_faces = mesh.faces != m_mesh.faces;
    const bool is_other = has_other_faces || mesh.limbs != m_mesh.limbs;
    m_changes = is_first || !is_other ? 0 : m_changes + 1;
    if (m_changes == kFew)
        m_troubles.push_back(
            "its faces, or their limbs, are others in each call, so the hierarchy of its faces is "
            "built anew each time, and takes memory for 1,000 steps. Remedy: make faces and limbs "
            "once, and move the vertices alone");
    if (has_other_faces && m_changes < kFew && !m_told_of_orientation) checkOrientation(mesh);
}

void AnimatedObstacle::checkOrientation(const AnimatedMesh& mesh) {
    const OrientationFaults faults = orientation_faults(mesh.x0, *mesh.faces);
    if (!faults.any()) return;
    std::ostringstream text;
    if (faults.inside_out_face >= 0)
        text << "it is inside out, its faces look inwards, such as face " << faults.inside_out_face
             << ", and cloth is drawn in. Remedy: turn its faces (flip normals) in a mesh editor, "
                "or swap two corners of each; nothing, if cloth is to stay in it";
    else if (faults.turned_edges > 0)
        text << "face " << faults.turned_face
             << " looks to the other side than one beside it, as faces at " << faults.turned_edges
             << " edges do, and cloth is drawn in there. Remedy: make all of its faces look "
                "outwards (recalculate normals) in a mesh editor";
    else
        text << "face " << faults.repeated_face << " stands there twice, once turned round, as "
             << faults.repeated_faces
             << " faces do, so cloth cannot tell its sides apart. Remedy: remove the faces that "
                "look inwards; leave out parts with two sides, such as hair";
    m_troubles.push_back(text.str());
    m_told_of_orientation = true;
}

/// The pose at the end of the last world step. As a rule it is x1, whose memory is taken over.
void AnimatedObstacle::rememberPose() {
    m_last_faces = m_mesh.faces;
    if (m_stands || std::abs(m_end / m_mesh.duration - 1.0) < kSameTime)
        m_last.swap(m_mesh.x1);
    else
        m_last = pose(m_end);
}

void AnimatedObstacle::beginStep(double h, bool is_in_world, const std::vector<Box>& placed) {
    const bool acted = m_acts;
    m_was_in_world = m_was_in_world || is_in_world;
    m_acts = !hasLeft(is_in_world);
    const bool is_new = m_end == 0.0;
    m_begin = m_end;
    m_end += h;
    m_jumped_from.reset();
    if (is_new) {
        m_box0 = boxAround(m_mesh.x0);
        const bool placed_at_it = std::any_of(placed.begin(), placed.end(), [&](const Box& box) {
            return m_box0.overlaps(box.low, box.high);
        });
        start(h, acted && !placed_at_it);
    } else if (!m_stands && m_begin >= 0.999 * m_mesh.duration) {
        arrive(h);
    }
}

void AnimatedObstacle::start(double h, bool follows) {
    constexpr double kMostDurations = 4.0;  // in a world step, for x1 and what is beyond it
    constexpr double kJump = 0.5;           // m: nobody moves as far in no time
    const bool is_short = m_mesh.duration > 0.0 && h > kMostDurations * m_mesh.duration;
    m_short_durations = is_short ? m_short_durations + 1 : 0;
    if (m_short_durations == 3) {  // one frame may take long
        std::ostringstream text;
        text << "its duration of " << m_mesh.duration
             << " s is less than a quarter of the world step of " << h
             << " s, at whose end it is at x1. Remedy: the time (s) of the stepSimulation() that "
                "follows, or 0";
        m_troubles.push_back(text.str());
    }
    if (is_short || !(m_mesh.duration > 0.0)) m_mesh.duration = h;
    m_box1 = boxAround(m_mesh.x1);
    const bool has_last = m_last.rows() == m_mesh.x0.rows();
    const PoseGap gap = has_last ? gapBetween(m_mesh.x0, m_last) : PoseGap();
    m_moves = !has_last || gap.largest > 0.0 || m_mesh.x0 != m_mesh.x1;
    if (gap.mean > kJump * kJump) {
        m_jumped_from = boxAround(m_last);
    } else if (follows && isApart(gap) && m_last_faces == m_mesh.faces) {
        m_from_last = true;
        m_box0 = m_box1 = boxAroundBoth(boxAround(m_last), m_box1);
    }
}

/// It stands from now on. Where it went on beyond x1, it comes back in this world step.
void AnimatedObstacle::arrive(double h) {
    if (std::abs(m_begin / m_mesh.duration - 1.0) >= kSameTime) {
        Points here = pose(m_begin);
        if (isApart(gapBetween(here, m_mesh.x1))) {
            m_last = std::move(here);
            m_last_faces = m_mesh.faces;
            m_mesh.x0 = m_mesh.x1;
            m_mesh.duration = h;
            m_begin = 0.0;
            m_end = h;
            m_from_last = m_moves = true;
            m_box0 = m_box1 = boxAroundBoth(boxAround(m_last), m_box1);
            return;
        }
    }
    m_stands = true;
}

Points AnimatedObstacle::pose(double time) const {
    const double s = m_stands ? 1.0 : time / m_mesh.duration;
    const Points& from = m_from_last && s < 1.0 ? m_last : m_mesh.x0;
    if (s == 0.0) return from;
    if (std::abs(s - 1.0) < kSameTime) return m_mesh.x1;
    return from + s * (m_mesh.x1 - from);
}

bool AnimatedObstacle::isNear(const Vec3& low, const Vec3& high) const {
    return m_box0.overlaps(low, high) || m_box1.overlaps(low, high);
}

bool AnimatedObstacle::jumpsFrom(const Vec3& low, const Vec3& high) const {
    return m_jumped_from && m_jumped_from->overlaps(low, high);
}

std::vector<std::string> AnimatedObstacle::takeTroubles() {
    return std::exchange(m_troubles, {});
}

}  // namespace cloth
