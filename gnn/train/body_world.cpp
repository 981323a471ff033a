#include "gnn/train/body_world.h"

#include <algorithm>
#include <utility>

#include "data/body/garment_skinning.h"

namespace cloth {

namespace {

class BodyWorld : public TrainingWorld {
 public:
    BodyWorld(std::shared_ptr<const AnimatedBody> body, const Eigen::Matrix3d& turn)
        : m_body(std::move(body)), m_turn(turn) {}

    void boundary(double time, double dt, Boundary& out) override {
        out.obstacles.resize(1);
        out.obstacles[0] = m_body->obstacle(time, time + dt);
        out.obstacles[0].x0 = (out.obstacles[0].x0 * m_turn.transpose()).eval();
        out.obstacles[0].x1 = (out.obstacles[0].x1 * m_turn.transpose()).eval();
        out.pin_targets.resize(0, 3);
    }

 private:
    std::shared_ptr<const AnimatedBody> m_body;
    Eigen::Matrix3d m_turn;
};

}  // namespace

SceneParts make_body_parts(std::shared_ptr<const Garment> garment,
                           std::shared_ptr<const AnimatedBody> body, double yaw, ClothState start) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(yaw, Vec3::UnitY()).toRotationMatrix();
    SceneParts parts;
    parts.kind = "garment";
    parts.start = std::move(start);
    parts.start.x = (parts.start.x * turn.transpose()).eval();
    parts.start.v = (parts.start.v * turn.transpose()).eval();
    parts.garment = std::move(garment);
    parts.world = std::make_unique<BodyWorld>(std::move(body), turn);
    return parts;
}

Motion motion_from(const Motion& motion, int frame, int least) {
    Motion part = motion;
    const int first = std::clamp(frame, 0, std::max(0, motion.frame_count() - least));
    part.frames.erase(part.frames.begin(), part.frames.begin() + first);
    return part;
}

Points carried_along(const Points& garment, const Points& skin_before, const Points& skin_after) {
    const Points displacement = skin_after - skin_before;
    Points carried = Points::Zero(garment.rows(), 3);
    for_each_skin_neighbour(garment, skin_before,
                            [&](Eigen::Index i, Eigen::Index vertex, double weight) {
                                carried.row(i) += weight * displacement.row(vertex);
                            });
    return carried;
}

}  // namespace cloth
