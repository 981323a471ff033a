#include "data/body/garment_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "data/body/body_shapes.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/garment_assets.h"
#include "data/files/mesh_io.h"
#include "tests/data/authoring/garment_checks.h"

namespace cloth::garment_fit_test {

using namespace cloth::test;

namespace {

const TriMesh& default_body() {
    static const TriMesh body = load_mesh(model_path("Collada/human.zae"), "human-baseMesh");
    return body;
}

const TriMesh& shirt() {
    static const TriMesh mesh = load_garment_mesh("tshirt_1000");
    return mesh;
}

void expect_fits(const Points& fitted, const Points& body) {
    EXPECT_GE(
        smallest_clearance({fitted, shirt().faces}, SurfaceDistance({body, default_body().faces})),
        0.004);
    EXPECT_GT(smallest_angle({fitted, shirt().faces}), 15.0) << "the cloth is distorted";
}

}  // namespace

TEST(FitGarment, SameBodyLeavesTheGarmentWhereItIs) {
    const Points fitted = fit_garment(shirt(), default_body(), default_body().vertices);
    EXPECT_LT((fitted - shirt().vertices).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(FitGarment, TranslationCarriesTheGarmentAlong) {
    const Eigen::RowVector3d shift(0.3, -1.0, 2.0);
    const Points fitted =
        fit_garment(shirt(), default_body(), default_body().vertices.rowwise() + shift);
    EXPECT_LT((fitted - (shirt().vertices.rowwise() + shift)).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(FitGarment, LargerBodyGetsALargerGarment) {
    const Points body = 1.1 * default_body().vertices;
    const Points fitted = fit_garment(shirt(), default_body(), body);
    expect_fits(fitted, body);
    EXPECT_NEAR(fitted.col(1).minCoeff(), 1.1 * shirt().vertices.col(1).minCoeff(), 0.02);
    const Vec3 before =
        shirt().vertices.colwise().maxCoeff() - shirt().vertices.colwise().minCoeff();
    const Vec3 after = fitted.colwise().maxCoeff() - fitted.colwise().minCoeff();
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(after[axis] / before[axis], 1.1, 0.03);
}

TEST(FitGarment, BellyPushesTheShirtOutAndNothingElse) {
    Points body = default_body().vertices;
    for (Eigen::Index i = 0; i < body.rows(); ++i) {
        const double away = (Vec3(body.row(i)) - Vec3(0, 1.0, 0.13)).norm() / 0.12;
        if (away < 1.0) body(i, 2) += 0.08 * std::pow(1.0 - away * away, 2);
    }
    const Points fitted = fit_garment(shirt(), default_body(), body);
    expect_fits(fitted, body);
    double most = 0.0, neck = 0.0;
    for (Eigen::Index i = 0; i < fitted.rows(); ++i) {
        const double move = (fitted.row(i) - shirt().vertices.row(i)).norm();
        most = std::max(most, move);
        if (fitted(i, 1) > 1.35) neck = std::max(neck, move);
    }
    EXPECT_GT(most, 0.05);
    EXPECT_LT(neck, 0.002);
}

TEST(FitGarment, SampledPeopleAreDressed) {
    const std::optional<BodyShapes> shapes = BodyShapes::load_shared();
    if (!shapes) GTEST_SKIP() << "no body shapes in the shared data folder";
    for (uint64_t seed = 1; seed <= 3; ++seed) {
        const Points body = shapes->skin(sample_body_shape(seed));
        expect_fits(fit_garment(shirt(), default_body(), body), body);
    }
}

TEST(FitGarment, OtherBodiesAreRefused) {
    EXPECT_THROW(fit_garment(shirt(), default_body(), default_body().vertices.topRows(100)),
                 ArgumentError);
    Points body = default_body().vertices;
    body(17, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(fit_garment(shirt(), default_body(), body), ArgumentError);
}

}  // namespace cloth::garment_fit_test
