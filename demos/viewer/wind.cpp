#include "demos/viewer/wind.h"

#include <cmath>

#include "data/core/check_range.h"

namespace cloth {

bool operator==(const WindSettings& a, const WindSettings& b) {
    return a.speed == b.speed && a.direction == b.direction && a.gusts == b.gusts;
}

void check(const WindSettings& settings) {
    check_range("WindSettings.speed", settings.speed, 0.0, 20.0);
    check_range("WindSettings.direction", settings.direction, -360.0, 360.0);
    check_range("WindSettings.gusts", settings.gusts, 0.0, 1.0);
}

Vec3 wind_velocity(const WindSettings& settings, double time) {
    // Two periods that have no small common multiple: gusts that do not seem to repeat.
    const double swing =
        0.6 * std::sin(2.0 * M_PI * 0.31 * time) + 0.4 * std::sin(2.0 * M_PI * 0.83 * time + 1.3);
    const double angle = settings.direction * M_PI / 180.0;
    return settings.speed * (1.0 + settings.gusts * swing) *
           Vec3(std::sin(angle), 0.0, std::cos(angle));
}

Points wind_accelerations(const WindSettings& settings, const Garment& garment,
                          const ClothState& state, double dt) {
    if (settings.speed == 0.0) return {};
    constexpr double air = 1.2;  // (kg/m^3)
    const Vec3 wind = wind_velocity(settings, state.time);
    const double resistance = 0.5 * air / garment.fabric().density;  // k / m (1/m)
    const Faces& faces = garment.rest().faces;
    const Points normals = face_normals(state.x, faces);
    Points accelerations = Points::Zero(garment.vertex_count(), 3);
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const Vec3 velocity =
            (state.v.row(faces(f, 0)) + state.v.row(faces(f, 1)) + state.v.row(faces(f, 2))) / 3.0;
        const Vec3 normal = normals.row(f).transpose();
        const double along = (wind - velocity).dot(normal);
        const double rate = resistance * std::abs(along);  // (1/s)
        const double mass = garment.fabric().density * garment.face_areas()[f] / 3.0;
        const Vec3 force = mass * rate * along / (1.0 + rate * dt) * normal;
        for (int k = 0; k < 3; ++k) accelerations.row(faces(f, k)) += force.transpose();
    }
    for (Eigen::Index i = 0; i < accelerations.rows(); ++i)
        accelerations.row(i) /= garment.masses()[i];
    return accelerations;
}

}  // namespace cloth
