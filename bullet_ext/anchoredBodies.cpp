#include "bullet_ext/anchoredBodies.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletSoftBody/btSoftBody.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "bullet_ext/softBodyGarment.h"

namespace cloth {

namespace {

constexpr int kTrials = 8;
constexpr int kIterations = 1600;                  // of the cloth, after which no trial begins
constexpr double kClose = 5e-4;                    // m: by so little an anchor may be wrong
constexpr double kResidual = 3e-2;                 // of accurate steps of the cloth
constexpr double kFarthestWay = 0.3, kTurn = 0.6;  // m, rad: that a body is moved

Eigen::Matrix3d turnOf(const Vec3& way) {
    const double angle = way.norm();
    return angle > 0.0 ? Eigen::AngleAxisd(angle, way / angle).toRotationMatrix()
                       : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
}

Eigen::Matrix<double, 3, 6> motionAt(const Vec3& arm) {
    Eigen::Matrix<double, 3, 6> motion;
    motion << Eigen::Matrix3d::Identity(), -crossMatrix(arm);
    return motion;
}

/// Of a mass of 1 kg at that arm.
Matrix6 inertiaAt(const Vec3& arm) {
    const Eigen::Matrix<double, 3, 6> motion = motionAt(arm);
    const Eigen::Matrix<double, 6, 3> back = motion.transpose();
    return back * motion;
}

Vector6 turned(const Eigen::Matrix3d& turn, const Vector6& motion) {
    const Vec3 along = motion.head<3>(), about = motion.tail<3>();
    Vector6 result;
    result.head<3>() = turn * along;
    result.tail<3>() = turn * about;
    return result;
}

}  // namespace

bool AnchoredBodies::begin(const btSoftBody& body, const Garment& garment, double length) {
    m_bodies.clear();
    m_trials = 0;
    m_best.x.resize(0, 3);
    m_garment = &garment;
    m_length = length;
    const std::vector<int>& pins = garment.pins();
    for (int a = 0; a < body.m_anchors.size(); ++a) {
        const btSoftBody::Anchor& anchor = body.m_anchors[a];
        if (!isHardAnchor(anchor) || !(anchor.m_node->m_im > 0) || !isDynamic(*anchor.m_body))
            continue;
        const int node = static_cast<int>(anchor.m_node - &body.m_nodes[0]);
        const auto pin = std::lower_bound(pins.begin(), pins.end(), node);
        const Vec3 place = toVec3(anchor.m_body->getWorldTransform() * anchor.m_local);
        if (pin == pins.end() || *pin != node || !place.allFinite()) continue;
        auto found = std::find_if(m_bodies.begin(), m_bodies.end(),
                                  [&](const Hanging& h) { return h.body == anchor.m_body; });
        if (found == m_bodies.end())
            found = m_bodies.insert(found, {anchor.m_body,
                                            {},
                                            Eigen::Matrix3d::Identity(),
                                            Matrix6::Zero(),
                                            Matrix6::Zero(),
                                            0.0});
        found->anchors.push_back(
            {node, pin - pins.begin(), place - centreOf(*anchor.m_body), anchor.m_local});
    }
    if (m_bodies.empty()) return false;
    m_mass_ratio = massRatio(body, garment);
    m_masses = m_mass_ratio * garment.masses();
    for (int i = 0; i < body.m_nodes.size(); ++i)
        if (!(body.m_nodes[i].m_im > 0)) m_masses[i] = 0.0;
    for (Hanging& hanging : m_bodies) {
        hanging.frame = toMatrix(hanging.body->getCenterOfMassTransform().getBasis());
        Matrix6 mass = massMatrix(*hanging.body);
        mass.bottomRightCorner<3, 3>() =
            hanging.frame.transpose() * mass.bottomRightCorner<3, 3>().eval() * hanging.frame;
        hanging.carried.setZero();
        for (const Anchor& anchor : hanging.anchors) {
            hanging.carried +=
                m_masses[anchor.node] * inertiaAt(hanging.frame.transpose() * anchor.arm);
        }
        hanging.root = (mass + hanging.carried).llt().matrixL();
    }
    m_u = VectorX::Zero(static_cast<Eigen::Index>(6 * m_bodies.size()));
    m_best_u = m_u;
    findFollowing(nodePositions(body));
    if (m_inverse.rows() != m_u.size() || m_inverse_length != length || !m_inverse.allFinite())
        guessInverse();
    return true;
}

/// With the nodes around the anchors at rest: they resist no more than that.
void AnchoredBodies::guessInverse() {
    constexpr double kEdges = 4.0;  // that a node pulls lengthwise
    m_inverse_length = m_length;
    const double stiffness = kEdges * m_mass_ratio * m_garment->fabric().longitudinal();
    m_inverse = Eigen::MatrixXd::Identity(m_u.size(), m_u.size());
    for (size_t b = 0; b < m_bodies.size(); ++b) {
        const Hanging& hanging = m_bodies[b];
        Matrix6 resists = Matrix6::Zero();
        for (const Anchor& anchor : hanging.anchors) {
            resists +=
                m_length * m_length * stiffness * inertiaAt(hanging.frame.transpose() * anchor.arm);
        }
        setInverse(b, resists, m_inverse);
    }
}

/// The part of a body, where the cloth resists like this mass.
void AnchoredBodies::setInverse(size_t body, const Matrix6& mass, Eigen::MatrixXd& inverse) const {
    const auto root = m_bodies[body].root.triangularView<Eigen::Lower>();
    const Matrix6 half = root.solve(mass);
    const Matrix6 scaled = root.solve(Matrix6(half.transpose()));
    const auto at = static_cast<Eigen::Index>(6 * body);
    inverse.block<6, 6>(at, at) = (Matrix6::Identity() + scaled).inverse();
}

/// The inverse Hessian if nothing but the mass of the cloth resisted, as far as a stretch wave
/// runs.
void AnchoredBodies::findFollowing(const Points& x) {
    const Fabric& fabric = m_garment->fabric();
    const double reach = m_length * std::sqrt(fabric.longitudinal() / fabric.density);
    m_follows = Eigen::MatrixXd::Identity(m_u.size(), m_u.size());
    for (size_t b = 0; b < m_bodies.size(); ++b) {
        const Hanging& hanging = m_bodies[b];
        Matrix6 follows = Matrix6::Zero();
        for (int i = 0; i < static_cast<int>(x.rows()); ++i) {
            const Anchor* nearest = nullptr;
            double distance = reach;
            for (const Anchor& anchor : hanging.anchors) {
                const double d = (x.row(i) - x.row(anchor.node)).norm();
                if (d < distance) distance = d, nearest = &anchor;
            }
            if (!nearest || nearest->node == i) continue;
            follows += (1.0 - distance / reach) * m_masses[i] *
                       inertiaAt(hanging.frame.transpose() * nearest->arm);
        }
        setInverse(b, follows, m_follows);
    }
}

Vector6 AnchoredBodies::wayOf(size_t body, const VectorX& u) const {
    const Hanging& hanging = m_bodies[body];
    const Vector6 part = u.segment<6>(static_cast<Eigen::Index>(6 * body));
    const Vector6 own = hanging.root.transpose().triangularView<Eigen::Upper>().solve(part);
    return turned(hanging.frame, m_length * own);
}

Vec3 AnchoredBodies::placeOf(const Hanging& hanging, const Anchor& anchor,
                             const Vector6& way) const {
    return centreOf(*hanging.body) + way.head<3>() + turnOf(way.tail<3>()) * anchor.arm;
}

/// Of a node's velocity, by other things than accelerations.
Vec3 AnchoredBodies::changeOf(Eigen::Index node, const Boundary& boundary, const ClothState& from,
                              const ClothState& to) const {
    Vec3 change = to.v.row(node) - from.v.row(node);
    change -= m_length * boundary.gravity;
    if (boundary.accelerations.size())
        change -= m_length * boundary.accelerations.row(node).transpose();
    return change;
}

/// u less what the impulses of the cloth make of it.
VectorX AnchoredBodies::residual(const Boundary& boundary, const ClothState& from,
                                 const ClothState& to) const {
    VectorX result = m_u;
    for (size_t b = 0; b < m_bodies.size(); ++b) {
        const Hanging& hanging = m_bodies[b];
        const Eigen::Matrix3d turn = turnOf(wayOf(b, m_u).tail<3>());
        Vector6 impulse = Vector6::Zero();
        for (const Anchor& anchor : hanging.anchors) {
            const int i = anchor.node;
            const Vec3 given = m_length * m_mass_ratio * Vec3(m_internal.row(i)) -
                               m_masses[i] * changeOf(i, boundary, from, to);
            impulse.head<3>() += given;
            impulse.tail<3>() += Vec3(turn * anchor.arm).cross(given);
        }
        const Eigen::Matrix3d back = hanging.frame.transpose();
        const Vector6 change = turned(back, wayOf(b, m_u)) / m_length;
        const Vector6 own = turned(back, impulse) + hanging.carried * change;
        result.segment<6>(static_cast<Eigen::Index>(6 * b)) -=
            hanging.root.triangularView<Eigen::Lower>().solve(own);
    }
    return result;
}

/// The incremental potential of the common step (J), without that of contacts; m_residual is its
/// gradient. If the stepper does not know the fabric's, half the square of the residual.
double AnchoredBodies::energy(const Stepper& stepper, const Boundary& boundary,
                              const ClothState& from, const ClothState& to) const {
    const std::optional<double> internal = stepper.internal_energy(to.x);
    if (!internal) return 0.5 * m_residual.squaredNorm();
    double sum = m_mass_ratio * *internal;
    for (Eigen::Index i = 0; i < to.x.rows(); ++i)
        sum += 0.5 * m_masses[i] * changeOf(i, boundary, from, to).squaredNorm();
    for (size_t b = 0; b < m_bodies.size(); ++b) {
        const Vector6 change = turned(m_bodies[b].frame.transpose(), wayOf(b, m_u)) / m_length;
        sum += 0.5 * m_u.segment<6>(static_cast<Eigen::Index>(6 * b)).squaredNorm() -
               0.5 * change.dot(m_bodies[b].carried * change);
    }
    return sum;
}

void AnchoredBodies::limit(VectorX& u) const {
    for (size_t b = 0; b < m_bodies.size(); ++b) {
        const Vector6 way = wayOf(b, u);
        const double too_far =
            std::max({1.0, way.head<3>().norm() / kFarthestWay, way.tail<3>().norm() / kTurn});
        u.segment<6>(static_cast<Eigen::Index>(6 * b)) /= too_far;
    }
}

/// By how much an anchor moves at most (m).
double AnchoredBodies::motion(const VectorX& u0, const VectorX& u1) const {
    double most = 0.0;
    for (size_t b = 0; b < m_bodies.size(); ++b) {
        const Vector6 way0 = wayOf(b, u0), way1 = wayOf(b, u1);
        for (const Anchor& anchor : m_bodies[b].anchors)
            most = std::max(
                most,
                (placeOf(m_bodies[b], anchor, way1) - placeOf(m_bodies[b], anchor, way0)).norm());
    }
    return most;
}

bool AnchoredBodies::tryAgain(const Stepper& stepper, const ClothState& from, Boundary& boundary,
                              ClothState& to, StepReport& report) {
    const bool first = m_trials++ == 0;
    if (!report.finite) {
        if (m_best.x.rows() == 0) return false;
        m_u = m_best_u;
        to = m_best;
        report = m_best_report;
        return false;
    }
    if (!stepper.internal_forces(to.x, m_internal)) return false;
    if (first && !m_accurate) {
        m_residual = residual(boundary, from, to);
        if (motion(m_u, m_u - m_follows * m_residual) < kClose) return false;
        m_accurate = true;
        m_trials = 0;
        m_best = to;
        m_best_report = report;
        return true;
    }
    const VectorX last = m_residual;
    m_residual = residual(boundary, from, to);
    if (!first) updateInverse(m_u - m_last_u, m_residual - last);
    const double merit = energy(stepper, boundary, from, to);
    if (first) {
        m_trusted = std::numeric_limits<double>::infinity();
        m_iterations = 0;
    }
    m_iterations += report.iterations;
    if (first || merit < m_least) {
        m_least = merit;
        m_best_u = m_u;
        m_best_residual = m_residual;
        m_best = to;
        m_best_report = report;
    }
    m_last_u = m_u;
    VectorX next = nextTrial(merit);
    limit(next);
    if (m_trials == kTrials || m_iterations > kIterations || !next.allFinite() ||
        motion(m_u, m_u - m_follows * m_residual) < kClose) {
        if (m_trials > 1 && m_best_u.isZero(0.0)) m_inverse.resize(0, 0);  // it has led astray
        m_accurate = m_trials > 1;
        m_u = m_best_u;
        to = m_best;
        report = m_best_report;
        return false;
    }
    m_u = next;
    for (size_t b = 0; b < m_bodies.size(); ++b) {
        const Vector6 way = wayOf(b, m_u);
        for (const Anchor& anchor : m_bodies[b].anchors)
            boundary.pin_targets.row(anchor.pin) = placeOf(m_bodies[b], anchor, way);
    }
    return true;
}

/// The step of the quasi-Newton method from the best trial, as far as it is trusted. A step that
/// has made energy is cut to where a parabola through it and the best trial is least, unless that
/// is far.
VectorX AnchoredBodies::nextTrial(double merit) {
    constexpr double kNear = 0.5, kNearest = 0.1;  // of the last step
    const VectorX last = m_u - m_best_u;
    const double slope = m_best_residual.dot(last);
    if (merit <= m_least) m_trusted *= 2.0;
    if (merit > m_least && slope < 0.0) {
        const double part = -0.5 * slope / (merit - m_least - slope);
        m_trusted = std::clamp(part, kNearest, kNear) * last.norm();
        if (part < kNear) return m_best_u + std::max(kNearest, part) * last;
    }
    const VectorX step = -m_inverse * m_best_residual;
    return m_best_u + std::min(1.0, m_trusted / step.norm()) * step;
}

/// BFGS, for a step s of u and the change y of the residual.
void AnchoredBodies::updateInverse(const VectorX& s, const VectorX& y) {
    const double curvature = s.dot(y);
    if (!(curvature > 1e-12 * s.norm() * y.norm())) return;
    const Eigen::MatrixXd left =
        Eigen::MatrixXd::Identity(s.size(), s.size()) - s * y.transpose() / curvature;
    m_inverse = (left * m_inverse * left.transpose() + s * s.transpose() / curvature).eval();
}

double AnchoredBodies::mostResidual() const {
    return m_accurate ? kResidual : std::numeric_limits<double>::infinity();
}

void AnchoredBodies::place(ClothState& to) {
    for (size_t b = 0; b < m_bodies.size(); ++b) {
        Hanging& hanging = m_bodies[b];
        btRigidBody& body = *hanging.body;
        const Vector6 way = wayOf(b, m_u);
        hanging.lift = -toVec3(body.getGravity()).dot(way.head<3>()) / body.getInvMass();
        if (way.isZero(0.0)) continue;
        btTransform pose = body.getCenterOfMassTransform();
        pose.setOrigin(pose.getOrigin() + toBullet(Vec3(way.head<3>())));
        const Vec3 turn = way.tail<3>();
        if (turn.norm() > 0.0)
            pose.setRotation(btQuaternion(toBullet(Vec3(turn.normalized())),
                                          static_cast<btScalar>(turn.norm())) *
                             pose.getRotation());
        body.setCenterOfMassTransform(pose);
    }
    for (const Hanging& hanging : m_bodies)
        for (const Anchor& anchor : hanging.anchors)
            to.x.row(anchor.node) = toVec3(hanging.body->getWorldTransform() * anchor.local);
}

Vector6 AnchoredBodies::changeOf(const btRigidBody& body) const {
    for (size_t b = 0; b < m_bodies.size(); ++b)
        if (m_bodies[b].body == &body) return wayOf(b, m_u) / m_length;
    return Vector6::Zero();
}

double AnchoredBodies::liftOf(const btRigidBody& body) const {
    for (const Hanging& hanging : m_bodies)
        if (hanging.body == &body) return hanging.lift;
    return 0.0;
}

}  // namespace cloth
