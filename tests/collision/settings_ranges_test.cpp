#include "collision/proximity/limb_overlap.h"
#include "collision/response/contact_projection.h"
#include "collision/response/skin_blend.h"
#include "collision/self/layer_contacts.h"
#include "collision/self/self_contact_settings.h"
#include "data/authoring/sheet.h"
#include "tests/ranges.h"

namespace cloth::test {
namespace {

TEST(SettingsRanges, Proximity) {
    const auto use = [](const ProximitySettings& settings) { Proximity{settings}; };
    expect_range("ProximitySettings.radius", &ProximitySettings::radius, 0.01, 2.0, use);
    expect_range("ProximitySettings.threads", &ProximitySettings::threads, 0, 1024, use);
}

TEST(SettingsRanges, LimbOverlap) {
    using S = LimbOverlapSettings;
    const auto use = [](const S& settings) { LimbOverlap{settings}; };
    expect_range("LimbOverlapSettings.reach", &S::reach, 0.01, 0.1, use);
    expect_range("LimbOverlapSettings.margin", &S::margin, 1e-3, 0.05, use);
    expect_range("LimbOverlapSettings.least_cover", &S::least_cover, 0.0, 0.2, use);
    expect_range("LimbOverlapSettings.pinch_cover", &S::pinch_cover, 0.0, 0.2, use);
    expect_range("LimbOverlapSettings.layer_room", &S::layer_room, 0.0, 0.1, use);
}

TEST(SettingsRanges, ContactProjection) {
    using S = ContactProjectionSettings;
    const Garment garment("sheet", make_sheet(1.0, 1.0, 20), Fabric::soft_cotton(), {});
    const auto use = [&](const S& settings) { ContactProjection(garment, settings); };
    expect_range("ContactProjectionSettings.allowed_depth", &S::allowed_depth, 0.0, 5e-3, use);
    expect_range("ContactProjectionSettings.iterations", &S::iterations, 0, 100, use);
    expect_range("ContactProjectionSettings.sweeps", &S::sweeps, 1, 1000, use);
    expect_range("ContactProjectionSettings.most", &S::most, 1.0, 10.0, use);
    expect_range("ContactProjectionSettings.growth", &S::growth, 0.01, 1.0, use);
}

TEST(SettingsRanges, SkinBlend) {
    using S = SkinBlendSettings;
    const auto use = [](const S& settings) { settings.check(); };
    expect_range("SkinBlendSettings.distance", &S::distance, 0.0, 5e-3, use);
    expect_range("SkinBlendSettings.deepest", &S::deepest, 0.01, 1.0, use);
    expect_range("fade_to(): weight", 0.0, 1.0, [](double value) { SkinBlend().fade_to(value); });
    expect_range("fade_to(): seconds", 0.0, 1e6,
                 [](double value) { SkinBlend().fade_to(1.0, value); });
}

TEST(SettingsRanges, SelfContact) {
    using S = SelfContactSettings;
    const auto use = [](const S& settings) { check_self_contact(settings); };
    expect_range("SelfContactSettings.thickness", &S::thickness, 1e-3, 2e-2, use);
    check_self_contact({});  // 0: off
    expect_range("SelfContactSettings.weight", &S::weight, 1e3, 1e6, use);
    expect_range("SelfContactSettings.rounds", &S::rounds, 0, 100, use);
    expect_range("SelfContactSettings.untangling_tension", &S::untangling_tension, 0.0, 10.0, use);
    expect_range("SelfContactSettings.untangling_moves", &S::untangling_moves, 0, 100, use);
    expect_range("SelfContactSettings.threads", &S::threads, 0, 1024, use);
}

TEST(SettingsRanges, LayerContacts) {
    using S = LayerContactSettings;
    const auto use = [](const S& settings) { check_layer_contacts(settings); };
    expect_range("LayerContactSettings.thickness", &S::thickness, 1e-3, 2e-2, use);
    expect_range("LayerContactSettings.threads", &S::threads, 0, 1024, use);
}

}  // namespace
}  // namespace cloth::test
