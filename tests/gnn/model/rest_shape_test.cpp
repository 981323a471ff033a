// Static scenes: whatever the solver, a sheet that hangs by two corners comes to rest where the
// reference does.

#include <gtest/gtest.h>

#include <cmath>

#include "data/authoring/sheet.h"
#include "data/core/paths.h"
#include "gnn/model/make_cloth.h"

namespace cloth::rest_shape_test {
namespace {

constexpr double dt = 1.0 / 30.0;
constexpr int ten_seconds = 300;  // small steps damp little

/// A sheet of 0.5 m in the x-y plane, held at its two upper corners.
struct Hanging {
    Hanging() : garment("sheet", upright(), Fabric::soft_cotton(), corners()) {
        boundary.pin_targets.resize(2, 3);
        for (Eigen::Index p = 0; p < 2; ++p)
            boundary.pin_targets.row(p) =
                garment.rest().vertices.row(garment.pins()[static_cast<size_t>(p)]);
    }

    static TriMesh upright() {
        TriMesh mesh = make_sheet(0.5, 0.5, 300);
        mesh.vertices.col(1).swap(mesh.vertices.col(2));
        return mesh;
    }

    static std::vector<int> corners() {
        const Points x = upright().vertices;
        std::vector<int> pins(2);
        for (const int side : {0, 1}) {
            Eigen::Index pin = 0;
            (x.col(1) + (side ? 1.0 : -1.0) * x.col(0)).maxCoeff(&pin);
            pins[static_cast<size_t>(side)] = static_cast<int>(pin);
        }
        return pins;
    }

    Points at_rest(Stepper& stepper) const {
        // A bulge to one side: a flat start could fold to either.
        ClothState state = ClothState::at_rest(garment);
        for (Eigen::Index i = 0; i < state.x.rows(); ++i)
            state.x(i, 2) += 0.03 * std::cos(M_PI * state.x(i, 0) / 0.5);
        for (int frame = 0; frame < ten_seconds; ++frame)
            EXPECT_TRUE(stepper.step(boundary, dt, state).finite) << "frame " << frame;
        return state.x;
    }

    Garment garment;
    Boundary boundary;
};

double rms_mm(const Points& a, const Points& b) {
    return 1e3 * std::sqrt((a - b).rowwise().squaredNorm().mean());
}

TEST(RestShape, SolverAndLearnedClothHangWhereTheReferenceDoes) {
    const Hanging scene;
    ClothStepper reference(scene.garment, ClothStepperSettings::reference());
    const Points expected = scene.at_rest(reference);
    ASSERT_GT(rms_mm(expected, scene.garment.rest().vertices), 5.0) << "it does not hang at all";
    ClothStepper solver(scene.garment, ClothStepperSettings::plain());
    EXPECT_LT(rms_mm(scene.at_rest(solver), expected), 2.0);
    const auto cloth = make_cloth(scene.garment);
    EXPECT_LT(rms_mm(scene.at_rest(*cloth), expected), 2.0);
    for (const char* network : {"fast", "baseline"}) {
        ClothSettings settings;
        settings.weights = std::make_shared<const EngineWeights>(
            Weights::load(asset_path(std::string("weights/") + network + ".safetensors")));
        const auto learned = make_cloth(scene.garment, settings);
        EXPECT_LT(rms_mm(scene.at_rest(*learned), expected), 2.0) << network;
    }
}

}  // namespace
}  // namespace cloth::rest_shape_test
