#include "data/authoring/sheet.h"
#include "data/authoring/tshirt.h"
#include "data/body/animated_body.h"
#include "data/body/garment_fit.h"
#include "data/body/skin_weights.h"
#include "data/body/skinned_character.h"
#include "data/core/garment.h"
#include "tests/ranges.h"

namespace cloth::test {
namespace {

TEST(SettingsRanges, Fabric) {
    const TriMesh sheet = make_sheet(1.0, 1.0, 20);
    const auto use = [&](const Fabric& fabric) { Garment("sheet", sheet, fabric, {}); };
    expect_range("sheet: fabric.density", &Fabric::density, 1e-3, 1e3, use);
    expect_range("sheet: fabric.mu", &Fabric::mu, 0.0, 1e6, use);
    expect_range("sheet: fabric.lambda", &Fabric::lambda, 0.0, 1e6, use);
    expect_range("sheet: fabric.bending", &Fabric::bending, 0.0, 1.0, use);
}

/// The ranges are checked first; what comes after them cannot be used here.
template <class Error, class Run>
void up_to(const Run& run) {
    try {
        run();
    } catch (const Error& error) {
        if (std::string(error.what()).find("out of range") != std::string::npos) throw;
    }
}

TEST(SettingsRanges, TshirtRecipe) {
    const auto use = [](const TshirtRecipe& recipe) {
        up_to<std::exception>([&] { make_tshirt(make_sheet(1.0, 1.0, 20), recipe); });
    };
    const std::string name = "TshirtRecipe.";
    expect_refused(name + "target_vertices", 499, [&](double value) {
        TshirtRecipe recipe;
        recipe.target_vertices = static_cast<int>(value);
        use(recipe);
    });
    expect_refused(name + "neck", std::nan(""), [&](double value) {
        TshirtRecipe recipe;
        recipe.neck.y() = value;
        use(recipe);
    });
    for (const auto& [field, member, low, high] :
         {std::tuple("neck_tilt", &TshirtRecipe::neck_tilt, 0.0, 60.0),
          std::tuple("neck_half_width", &TshirtRecipe::neck_half_width, 0.05, 0.15),
          std::tuple("neck_half_depth", &TshirtRecipe::neck_half_depth, 0.05, 0.15),
          std::tuple("sleeve_length", &TshirtRecipe::sleeve_length, 0.3, 0.8),
          std::tuple("hem_height", &TshirtRecipe::hem_height, 0.3, 1.5),
          std::tuple("chest_ease", &TshirtRecipe::chest_ease, 0.008, 0.05),
          std::tuple("sleeve_ease", &TshirtRecipe::sleeve_ease, 0.008, 0.05),
          std::tuple("drape_radius", &TshirtRecipe::drape_radius, 0.3, 10.0),
          std::tuple("clearance", &TshirtRecipe::clearance, 0.001, 0.01)})
        for (const double wrong : {low - 1e-9, high + 1e-9, std::nan("")})
            expect_refused(name + field, wrong, [&, part = member](double value) {
                TshirtRecipe recipe;
                recipe.*part = value;
                use(recipe);
            });
}

TEST(SettingsRanges, GarmentFit) {
    const TriMesh nothing;
    const auto use = [&](const GarmentFitSettings& settings) {
        up_to<ArgumentError>([&] { fit_garment(nothing, nothing, {}, settings); });
    };
    expect_range("GarmentFitSettings.clearance", &GarmentFitSettings::clearance, 1e-4, 0.05, use);
    expect_range("GarmentFitSettings.smoothing", &GarmentFitSettings::smoothing, 0, 500, use);
}

TEST(SettingsRanges, HeatWeights) {
    const TriMesh nothing;
    const auto use = [&](const HeatWeightSettings& settings) {
        up_to<ArgumentError>([&] { heat_weights(nothing, {}, 0, settings); });
    };
    expect_range("HeatWeightSettings.heat", &HeatWeightSettings::heat, 0.1, 10.0, use);
    expect_range("HeatWeightSettings.max_influences", &HeatWeightSettings::max_influences, 1, 8,
                 use);
    expect_range("HeatWeightSettings.threshold", &HeatWeightSettings::threshold, 0.0, 0.1, use);
}

TEST(SettingsRanges, Bvh) {
    const auto use = [](const BvhSettings& settings) {
        try {
            load_bvh("there is no such file.bvh", settings);
        } catch (const LoadError&) {  // the range was checked before
        }
    };
    expect_range("BvhSettings.scale", &BvhSettings::scale, 0.0, 1e3, use);
}

}  // namespace
}  // namespace cloth::test
