#include "data/authoring/garment_import.h"
#include "data/authoring/garment_recipe.h"
#include "data/authoring/sheet.h"
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

TEST(SettingsRanges, GarmentRecipe) {
    const auto use = [](const GarmentRecipe& recipe) { recipe.check(); };
    const std::string name = "GarmentRecipe.";
    for (const double wrong : {499.0, 60001.0})
        expect_refused(name + "target_vertices", wrong, [&](double value) {
            GarmentRecipe recipe;
            recipe.target_vertices = static_cast<int>(value);
            use(recipe);
        });
    expect_refused(name + "neck", std::nan(""), [&](double value) {
        GarmentRecipe recipe;
        recipe.landmarks["neck"] = Vec3(0.0, value, 0.0);
        use(recipe);
    });
    for (const double wrong : {0.34, 1.96})
        expect_refused(name + "hem", wrong, [&](double value) {
            GarmentRecipe recipe;
            recipe.to = GarmentRecipe::To::legs;
            recipe.hem = value;
            use(recipe);
        });
    for (const auto& [field, member, low, high] :
         {std::tuple("hem_height", &GarmentRecipe::hem_height, 0.02, 1.5),
          std::tuple("flare", &GarmentRecipe::flare, 0.0, 1.0)})
        for (const double wrong : {low - 1e-9, high + 1e-9, std::nan("")})
            expect_refused(name + field, wrong, [&, part = member](double value) {
                GarmentRecipe recipe;
                recipe.*part = value;
                use(recipe);
            });
    for (const auto& [field, member, low, high] :
         {std::tuple("sleeve_length", &GarmentRecipe::sleeve_length, 0.3, 1.95),
          std::tuple("hem", &GarmentRecipe::hem, -0.5, 1.95),
          std::tuple("rise", &GarmentRecipe::rise, -0.1, 0.15),
          std::tuple("neck_tilt", &GarmentRecipe::neck_tilt, 0.0, 60.0),
          std::tuple("neck_half_width", &GarmentRecipe::neck_half_width, 0.05, 0.15),
          std::tuple("neck_half_depth", &GarmentRecipe::neck_half_depth, 0.05, 0.15),
          std::tuple("strap_width", &GarmentRecipe::strap_width, 0.02, 0.1),
          std::tuple("armhole_drop", &GarmentRecipe::armhole_drop, 0.0, 0.1),
          std::tuple("ease", &GarmentRecipe::ease, 0.006, 0.05),
          std::tuple("sleeve_ease", &GarmentRecipe::sleeve_ease, 0.006, 0.05),
          std::tuple("leg_ease", &GarmentRecipe::leg_ease, 0.006, 0.05),
          std::tuple("drape_radius", &GarmentRecipe::drape_radius, 0.3, 10.0),
          std::tuple("clearance", &GarmentRecipe::clearance, 0.001, 0.01),
          std::tuple("band_width", &GarmentRecipe::band_width, 0.02, 0.1),
          std::tuple("band_ratio", &GarmentRecipe::band_ratio, 0.5, 1.0)})
        for (const double wrong : {low - 1e-9, high + 1e-9, std::nan("")})
            expect_refused(name + field, wrong, [&, part = member](double value) {
                GarmentRecipe recipe;
                recipe.*part = value;
                use(recipe);
            });
    GarmentRecipe recipe;
    recipe.sleeve_length = 0.0;
    EXPECT_NO_THROW(use(recipe)) << "no sleeves";
    recipe.landmarks["nose"] = Vec3::Zero();
    EXPECT_THROW(use(recipe), ArgumentError);
}

TEST(SettingsRanges, GarmentImport) {
    using S = GarmentImportSettings;
    const std::string name = "GarmentImportSettings.";
    const auto use = [](const S& settings) { settings.check(); };
    expect_range(name + "weld", &S::weld, 0.0, 0.01, use);
    expect_range(name + "clearance", &S::clearance, 1e-3, 0.05, use);
    expect_range(name + "most_inside", &S::most_inside, 0.0, 1.0, use);
    expect_range(name + "smallest_piece", &S::smallest_piece, 0.0, 1.0, use);
    expect_range(name + "vertices", &S::vertices, 500, 60000, use);
    S().check();  // 0 vertices: as they come
    expect_range(name + "band_width", &S::band_width, 0.02, 0.1, use);
    expect_range(name + "band_ratio", &S::band_ratio, 0.5, 1.0, use);
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
