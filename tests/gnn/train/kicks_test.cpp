#include "gnn/train/kicks.h"

#include <gtest/gtest.h>

#include "data/authoring/sheet.h"
#include "data/core/errors.h"

namespace cloth::kicks_test {
namespace {

class Kicks : public testing::Test {
 protected:
    ClothState kicked(const KickSettings& settings, std::uint64_t seed) const {
        ClothState state = ClothState::at_rest(m_garment);
        SceneRandom random(seed);
        kick(m_garment, settings, random, state);
        return state;
    }
    double offset(const ClothState& state) const {
        return (state.x - m_garment.rest().vertices).rowwise().norm().maxCoeff();
    }

    const Garment m_garment{"sheet", make_sheet(0.6, 0.6, 400), Fabric::soft_cotton(), {0, 7}};
};

TEST_F(Kicks, StayWithinTheirAmplitudesAndReachThem) {
    KickSettings settings;
    settings.noise_share = 0.0;
    double farthest = 0.0, fastest = 0.0;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        const ClothState state = kicked(settings, seed);
        farthest = std::max(farthest, offset(state));
        fastest = std::max(fastest, state.v.rowwise().norm().maxCoeff());
    }
    EXPECT_LE(farthest, settings.offset);
    EXPECT_GT(farthest, 0.5 * settings.offset);
    EXPECT_LE(fastest, settings.speed);
    EXPECT_GT(fastest, 0.8 * settings.speed);
}

TEST_F(Kicks, ShortWavesAreLow) {
    KickSettings settings;
    settings.noise_share = 0.0;
    settings.least_wavelength = settings.most_wavelength = 0.08;
    double farthest = 0.0;
    for (std::uint64_t seed = 0; seed < 100; ++seed)
        farthest = std::max(farthest, offset(kicked(settings, seed)));
    const double most = settings.slope * 0.08 / (2.0 * M_PI);
    EXPECT_LE(farthest, most * (1.0 + 1e-12));
    EXPECT_GT(farthest, 0.8 * most);
}

TEST_F(Kicks, LeavePinsAlone) {
    KickSettings settings;
    settings.noise_share = 1.0;
    const ClothState state = kicked(settings, 3);
    for (const int pin : m_garment.pins()) {
        EXPECT_EQ(state.x.row(pin), m_garment.rest().vertices.row(pin));
        EXPECT_EQ(state.v.row(pin).norm(), 0.0);
    }
    EXPECT_GT(offset(state), 0.0);
}

TEST_F(Kicks, AreAFunctionOfTheirSeed) {
    EXPECT_EQ(kicked({}, 5).x, kicked({}, 5).x);
    EXPECT_NE(kicked({}, 5).x, kicked({}, 6).x);
}

TEST_F(Kicks, WhiteNoiseHasItsDeviation) {
    Points x = m_garment.rest().vertices;
    SceneRandom random(1);
    add_white_noise(m_garment, 3e-3, random, x);
    const double sigma = std::sqrt((x - m_garment.rest().vertices).squaredNorm() / x.size());
    EXPECT_NEAR(sigma, 3e-3, 3e-4);
}

TEST_F(Kicks, RefuseSettingsOutOfRange) {
    const auto check = [](auto change) {
        KickSettings settings;
        change(settings);
        EXPECT_THROW(settings.check(), ArgumentError);
    };
    EXPECT_NO_THROW(KickSettings().check());
    check([](KickSettings& s) { s.share = 1.1; });
    check([](KickSettings& s) { s.most_wavelength = 0.05; });
    check([](KickSettings& s) { s.offset = -1e-3; });
    check([](KickSettings& s) { s.speed = std::nan(""); });
}

}  // namespace
}  // namespace cloth::kicks_test
