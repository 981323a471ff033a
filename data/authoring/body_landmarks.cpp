#include "data/authoring/body_landmarks.h"

#include <cmath>
#include <limits>

#include "data/core/errors.h"

namespace cloth {

namespace {

constexpr double kUpperArm = 0.24;  // of the default body (m)

/// The lowest skin between the legs.
Vec3 crotch_of(const Body& body, const Vec3& knee) {
    Vec3 lowest(0.0, std::numeric_limits<double>::infinity(), 0.0);
    for (Eigen::Index i = 0; i < body.rest().rows(); ++i) {
        const Vec3 p = body.rest().row(i);
        if (std::abs(p.x()) < 0.006 && p.y() > knee.y() && p.y() < lowest.y()) lowest = p;
    }
    if (!std::isfinite(lowest.y()))
        throw ArgumentError("body_landmarks: body", "no skin lies between its legs",
                            "give a body that stands upright around x = 0");
    return lowest;
}

}  // namespace

BodyLandmarks body_landmarks(const Body& body) {
    const auto joint = [&](const char* name) -> Vec3 {
        return body.joints()[static_cast<size_t>(body.joint(name))].position;
    };
    BodyLandmarks marks;
    marks.shoulder = joint("LeftArm");
    marks.elbow = joint("LeftForeArm");
    marks.wrist = joint("LeftFingerBase");  // the CMU skeleton's hand begins in the forearm
    const double scale = (marks.elbow - marks.shoulder).norm() / kUpperArm;
    marks.armpit = marks.shoulder + scale * Vec3(-0.004, -0.075, -0.011);
    marks.neck = joint("Neck") + scale * Vec3(0.0, -0.031, 0.020);
    marks.waist = joint("Spine");
    marks.hip = joint("LeftUpLeg");
    marks.knee = joint("LeftLeg");
    marks.ankle = joint("LeftFoot");
    marks.crotch = crotch_of(body, marks.knee);
    return marks;
}

}  // namespace cloth
