#include "gnn/train/kicks.h"

#include <algorithm>

#include "data/core/check_range.h"

namespace cloth {

namespace {

struct Wave {
    Vec3 number = Vec3::Zero();  ///< wave vector (1/m)
    Vec3 along = Vec3::Zero();   ///< unit
    double phase = 0.0;

    Wave(const KickSettings& settings, SceneRandom& random) {
        const double length =
            random.log_uniform(settings.least_wavelength, settings.most_wavelength);
        number = 2.0 * M_PI / length * random.direction();
        along = random.direction();
        phase = random.uniform(0.0, 2.0 * M_PI);
    }
    Vec3 at(const Vec3& x) const { return std::sin(number.dot(x) + phase) * along; }
};

}  // namespace

void KickSettings::check() const {
    check_range("KickSettings.share", share, 0.0, 1.0);
    check_range("KickSettings.least_wavelength", least_wavelength, 0.01, 10.0);
    check_range("KickSettings.most_wavelength", most_wavelength, least_wavelength, 10.0);
    check_range("KickSettings.slope", slope, 0.0, 1.0);
    check_range("KickSettings.offset", offset, 0.0, 0.1);
    check_range("KickSettings.speed", speed, 0.0, 10.0);
    check_range("KickSettings.noise_share", noise_share, 0.0, 1.0);
    check_range("KickSettings.noise", noise, 0.0, 0.02);
}

void add_white_noise(const Garment& garment, double sigma, SceneRandom& random, Points& x) {
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        for (int k = 0; k < 3; ++k) {
            const double noise = sigma * random.normal();
            if (!garment.is_pinned()[static_cast<size_t>(i)]) x(i, k) += noise;
        }
}

void kick(const Garment& garment, const KickSettings& settings, SceneRandom& random,
          ClothState& state) {
    const Wave offset(settings, random), speed(settings, random);
    const double most = std::min(settings.offset, settings.slope / offset.number.norm());
    const double metres = random.uniform(0.0, most);
    const double metres_per_second = random.uniform(0.0, settings.speed);
    for (Eigen::Index i = 0; i < state.x.rows(); ++i) {
        if (garment.is_pinned()[static_cast<size_t>(i)]) continue;
        const Vec3 x = state.x.row(i);
        state.x.row(i) += metres * offset.at(x).transpose();
        state.v.row(i) += metres_per_second * speed.at(x).transpose();
    }
    if (!random.chance(settings.noise_share)) return;
    add_white_noise(garment, random.uniform(0.0, settings.noise), random, state.x);
}

}  // namespace cloth
