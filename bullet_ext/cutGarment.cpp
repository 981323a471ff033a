// The garment of a soft body whose nodes and faces have changed.
#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bullet_ext/softBodyGarment.h"

namespace cloth {

namespace {

/// Two sides and the unit normal of a face.
Eigen::Matrix3d frameOf(const Points& x, const Faces& faces, Eigen::Index f) {
    Eigen::Matrix3d frame;
    frame.col(0) = (x.row(faces(f, 1)) - x.row(faces(f, 0))).transpose();
    frame.col(1) = (x.row(faces(f, 2)) - x.row(faces(f, 0))).transpose();
    frame.col(2) = frame.col(0).cross(frame.col(1)).stableNormalized();
    return frame;
}

/// A point by the two sides of a face and its normal.
Vec3 localOf(const Points& x, const Faces& faces, Eigen::Index f, const Vec3& point) {
    const Vec3 from_corner = point - Vec3(x.row(faces(f, 0)));
    return frameOf(x, faces, f).colPivHouseholderQr().solve(from_corner);
}

double squaredDistance(const Points& x, const Faces& faces, Eigen::Index f, const Vec3& point) {
    // By how far barycentric coordinates are outside, and the height: enough to choose by.
    const Vec3 local = localOf(x, faces, f, point);
    const double outside = std::max({0.0, -local[0], -local[1], local[0] + local[1] - 1.0});
    const double size = (x.row(faces(f, 1)) - x.row(faces(f, 0))).norm();
    return std::pow(outside * size, 2) + local[2] * local[2];
}

/// Where `point`, on the cloth at x or near it, is on the cloth at rest.
Vec3 restOf(const Garment& garment, const Points& x, const Vec3& point) {
    const Faces& faces = garment.rest().faces;
    Eigen::Index nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const double distance = squaredDistance(x, faces, f, point);
        if (distance < least) {
            least = distance;
            nearest = f;
        }
    }
    const Vec3 local = localOf(x, faces, nearest, point);
    const Points& rest = garment.rest().vertices;
    return Vec3(rest.row(faces(nearest, 0))) + frameOf(rest, faces, nearest) * local;
}

}  // namespace

std::optional<Garment> garmentAfterCut(const btSoftBody& body, const Garment& before,
                                       const Points& shown) {
    const Points now = nodePositions(body);
    const Eigen::Index old = shown.rows();
    const double same = 1e-4 * before.mean_edge_length();
    if (before.vertex_count() != old || now.rows() < old ||
        !((now.topRows(old) - shown).cwiseAbs().maxCoeff() <= same))
        return std::nullopt;
    Points rest(now.rows(), 3);
    rest.topRows(old) = before.rest().vertices;
    for (Eigen::Index i = old; i < now.rows(); ++i) rest.row(i) = restOf(before, shown, now.row(i));
    return garmentOfSoftBody(body, before.fabric(), rest, before.rest_angles_from_mesh());
}

}  // namespace cloth
