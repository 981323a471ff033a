// Clothes on characters whose animators think of something else: faster than people are, or with
// arms that pass through the trunk.

#include <algorithm>
#include <cmath>
#include <memory>

#include "data/authoring/sheet.h"
#include "data/body/animated_body.h"
#include "data/body/garment_skinning.h"
#include "data/files/garment_assets.h"
#include "demos/hard_cases/case_scenes.h"

namespace cloth {
namespace {

constexpr double degree = M_PI / 180.0;

std::shared_ptr<const AnimatedBody> animated(const Motion& motion) {
    return std::make_shared<const AnimatedBody>(std::make_shared<const Body>(Body::load_default()),
                                                motion);
}

std::vector<BodySegment> segments_of(const Body& body) {
    return segment_body(body.rest_mesh(), body.dominant_joint());
}

/// Jumps three times as fast as they were captured, and turns and darts about with them.
Motion frantic_motion() {
    Motion motion = load_motion_by_name("01_01");
    motion.frame_time /= 3.0;
    for (int k = 0; k < motion.frame_count(); ++k) {
        const double t = k * motion.frame_time;
        MotionFrame& frame = motion.frames[static_cast<size_t>(k)];
        const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.5 * std::sin(6.0 * t), Vec3::UnitY()));
        frame.rotations.front() = turn * frame.rotations.front();
        frame.root_position += Vec3(0.4 * std::sin(9.0 * t), 0.0, 0.3 * std::sin(7.0 * t));
    }
    return motion;
}

/// Both arms go down from 50 degrees to 115 and up again, so through the sides of the trunk and
/// half way through it, once a second.
Motion clipping_motion() {
    constexpr int frames = 90;
    Motion motion = load_motion_by_name("01_01");
    const MotionFrame first = motion.frames.front();
    motion.frames.assign(frames, first);
    motion.frame_time = 1.0 / 30.0;
    for (int k = 0; k < frames; ++k) {
        MotionFrame& frame = motion.frames[static_cast<size_t>(k)];
        for (Eigen::Quaterniond& rotation : frame.rotations) rotation.setIdentity();
        const double down = (82.5 - 32.5 * std::cos(2.0 * M_PI * k * motion.frame_time)) * degree;
        for (const auto& [arm, side] : {std::pair("LeftArm", -1.0), std::pair("RightArm", 1.0)})
            frame.rotations[static_cast<size_t>(motion.skeleton.find(arm).value())] =
                Eigen::AngleAxisd(side * down, Vec3::UnitZ());
    }
    return motion;
}

/// A sheet of 0.6 x 0.9 m that hangs 4 cm behind the back from the shoulders down.
TriMesh cape_behind(const Body& body, int vertices) {
    constexpr double width = 0.6, length = 0.9, away = 0.04;
    const double shoulders = body.joints()[static_cast<size_t>(body.joint("LeftArm"))].position.y();
    double back = 0.0;
    for (Eigen::Index i = 0; i < body.rest().rows(); ++i)
        if (body.rest()(i, 1) > shoulders - length) back = std::min(back, body.rest()(i, 2));
    TriMesh mesh = make_sheet(width, length, vertices);
    const Points level = mesh.vertices;
    const Eigen::RowVector3d middle =
        0.5 * (level.colwise().minCoeff() + level.colwise().maxCoeff());
    for (Eigen::Index i = 0; i < level.rows(); ++i)
        mesh.vertices.row(i) << level(i, 0) - middle.x(),
            shoulders - 0.5 * length + (level(i, 2) - middle.z()), back - away;
    return mesh;
}

/// The upper hem is where the skin carries it; downwards a vertex may be further away, and 4 cm
/// nearer to the body.
GoalLimits cape_limits(const Points& x) {
    const double top = x.col(1).maxCoeff();
    GoalLimits limits;
    limits.backstop.setConstant(x.rows(), 0.04);
    limits.max_distance.resize(x.rows());
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const double down = top - x(i, 1);
        limits.max_distance[i] = down < 0.03 ? 0.0 : 0.6 * down;
    }
    return limits;
}

}  // namespace

HardSceneParts fast_cape() {
    const std::shared_ptr<const AnimatedBody> body = animated(frantic_motion());
    const TriMesh mesh = cape_behind(body->body(), 600);
    const auto skinning =
        std::make_shared<const GarmentSkinning>(skin_garment(mesh.vertices, *body));
    Garment garment =
        Garment("cape", mesh, Fabric::real_cotton()).with_goals(cape_limits(mesh.vertices));
    const ClothState start = ClothState::at_rest(garment);
    const auto outside = [body, skinning](double t0, double t1) {
        Boundary boundary;
        boundary.pin_targets.resize(0, 3);
        boundary.obstacles.push_back(body->obstacle(t0, t1));
        boundary.goals = skinned_goals(*skinning, *body, t0, t1);
        return boundary;
    };
    HardSceneParts parts{std::move(garment), start, outside};
    parts.segments = segments_of(body->body());
    parts.self_contact.thickness = 4e-3;
    parts.limbs = true;
    return parts;
}

HardSceneParts clipping_armature() {
    const std::shared_ptr<const AnimatedBody> body = animated(clipping_motion());
    Garment garment = load_garment("tshirt_1000");
    const ClothState start = ClothState::at_rest(garment);
    const auto outside = [body](double t0, double t1) {
        Boundary boundary;
        boundary.pin_targets.resize(0, 3);
        boundary.obstacles.push_back(body->obstacle(t0, t1));
        return boundary;
    };
    HardSceneParts parts{std::move(garment), start, outside};
    parts.segments = segments_of(body->body());
    parts.limbs = true;
    return parts;
}

}  // namespace cloth
