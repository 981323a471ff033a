// The committed garments and the parts that garments are made with; making them is tested in
// garment_slow_test.cpp.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "data/authoring/edge_flips.h"
#include "data/authoring/make_garment.h"
#include "data/authoring/scalar_grid.h"
#include "data/authoring/sheet.h"
#include "data/authoring/surface_edit.h"
#include "data/body/clearance.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/garment_assets.h"
#include "data/files/mesh_io.h"
#include "tests/data/authoring/garment_checks.h"

namespace cloth::garment_test {

using namespace cloth::test;

namespace {

const SurfaceDistance& default_skin() {
    static const SurfaceDistance skin(load_mesh(model_path("Collada/human.zae"), "human-baseMesh"));
    return skin;
}

TriMesh ball(double radius, double cell = 0.05) {
    const Vec3 corner = Vec3::Constant(radius + 2.0 * cell);
    return ScalarGrid(-corner, corner, cell, [&](const Vec3& p) { return p.norm() - radius; })
        .zero_surface();
}

std::string recipe_file(const std::string& name, const std::string& text) {
    const std::string path = (std::filesystem::temp_directory_path() / name).string();
    std::ofstream(path) << text;
    return path;
}

std::string recipe_error(const std::string& name, const std::string& text) {
    const std::string path = recipe_file(name, text);
    std::string message = "no error";
    try {
        load_garment_recipe(path);
    } catch (const LoadError& error) {
        message = error.what();
    }
    std::filesystem::remove(path);
    return message;
}

}  // namespace

namespace {

GarmentRecipe committed_recipe(const std::string& name) {
    return load_garment_recipe(asset_path("garments/" + name + ".json"));
}

/// The recipe's name and number of vertices: pants_1000 has 1,000 and is of pants.
std::pair<std::string, int> recipe_of(const std::string& garment) {
    const size_t end = garment.find_last_not_of("0123456789");
    if (end + 1 == garment.size()) return {garment, committed_recipe(garment).target_vertices};
    return {garment.substr(0, end), std::stoi(garment.substr(end + 1))};
}

std::vector<std::string> bottoms() {
    return {"pants", "pants_1000", "shorts", "shorts_1000", "skirt", "skirt_1000"};
}

}  // namespace

class CommittedGarment : public testing::TestWithParam<std::string> {};

TEST_P(CommittedGarment, IsWornOutsideOfTheBodyAndWellShaped) {
    const auto [name, vertices] = recipe_of(GetParam());
    const GarmentRecipe recipe = committed_recipe(name);
    const int openings = (recipe.from == GarmentRecipe::From::shoulders ? 3 : 1) +
                         (recipe.to == GarmentRecipe::To::legs ? 2 : 1);
    TriMesh mesh = load_garment_mesh(GetParam());
    EXPECT_GT(smallest_angle(mesh), 20.0) << "at rest";
    mesh.vertices = load_garment_start(GetParam()).x;
    expect_garment(mesh, default_skin(), vertices, openings);
}

INSTANTIATE_TEST_SUITE_P(All, CommittedGarment, testing::ValuesIn(garment_names()),
                         [](const auto& test) { return test.param; });

class CommittedBottom : public testing::TestWithParam<std::string> {};

TEST_P(CommittedBottom, HasAWaistbandThatIsShorterAtRestThanWorn) {
    const GarmentRecipe recipe = committed_recipe(recipe_of(GetParam()).first);
    const TriMesh rest = load_garment_mesh(GetParam());
    const Points worn = load_garment_start(GetParam()).x;
    std::vector<std::vector<int>> loops = boundary_loops(rest.faces);
    const auto height = [&](const std::vector<int>& loop) { return centre_of(rest, loop).y(); };
    std::sort(loops.begin(), loops.end(),
              [&](const auto& a, const auto& b) { return height(a) > height(b); });
    EXPECT_NEAR(length_of(rest.vertices, loops[0]) / length_of(worn, loops[0]), recipe.band_ratio,
                0.02);
    for (size_t hem = 1; hem < loops.size(); ++hem)
        EXPECT_EQ(length_of(rest.vertices, loops[hem]), length_of(worn, loops[hem]));
    const double top = worn.col(1).maxCoeff();
    for (Eigen::Index i = 0; i < worn.rows(); ++i)
        if (worn(i, 1) < top - 3.6 * recipe.band_width) {
            EXPECT_EQ(rest.vertices.row(i), worn.row(i)) << "below the band nothing is stretched";
        }
}

INSTANTIATE_TEST_SUITE_P(All, CommittedBottom, testing::ValuesIn(bottoms()),
                         [](const auto& test) { return test.param; });

TEST(CommittedGarments, ListHasEachGarmentOnceAndNoWornShapes) {
    const std::vector<std::string> names = garment_names();
    for (const char* name : {"tshirt", "tshirt_1000", "tank_top", "long_top", "shirt", "pants",
                             "shorts", "skirt", "dress", "dress_1000"})
        EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
    for (const char* name : {"cape", "pants.worn"})
        EXPECT_EQ(std::count(names.begin(), names.end(), name), 0) << name;
}

TEST(CommittedGarments, AWrongNameIsAnsweredWithTheRightOnes) {
    try {
        load_garment_mesh("trousers");
        FAIL() << "there are no trousers";
    } catch (const LoadError& error) {
        const std::string text = error.what();
        for (const char* part : {"trousers", "pants_1000", "skirt", "tshirt"})
            EXPECT_NE(text.find(part), std::string::npos) << text;
    }
}

TEST(CommittedGarments, GarmentsWithoutAWaistbandAreWornAtRest) {
    EXPECT_EQ(load_garment_start("tshirt_1000").x, load_garment_mesh("tshirt_1000").vertices);
}

TEST(BodyLandmarks, FollowTheDefaultBody) {
    const BodyLandmarks marks = body_landmarks(Body::load_default());
    const BodyLandmarks cut = committed_recipe("tshirt").landmarks_on(marks);
    EXPECT_LT((marks.shoulder - cut.shoulder).norm(), 0.03);
    EXPECT_LT((marks.elbow - cut.elbow).norm(), 0.02);
    EXPECT_LT((marks.armpit - cut.armpit).norm(), 0.005);
    EXPECT_LT((marks.neck - cut.neck).norm(), 0.005);
    EXPECT_EQ(marks.knee, cut.knee) << "where the recipe has none";
    EXPECT_GT(marks.waist.y(), marks.hip.y());
    EXPECT_GT(marks.hip.y(), marks.crotch.y());
    EXPECT_GT(marks.crotch.y(), marks.knee.y());
    EXPECT_GT(marks.knee.y(), marks.ankle.y());
}

TEST(Tshirt, OpeningsAreWhereABodyComesOut) {
    const GarmentRecipe recipe = load_garment_recipe(asset_path("garments/tshirt.json"));
    const TriMesh shirt = load_garment_mesh("tshirt");
    const Openings openings = openings_of(shirt);
    for (int i : openings.hem) EXPECT_NEAR(shirt.vertices(i, 1), *recipe.hem_height, 1e-3);
    const Vec3 shoulder = recipe.landmarks.at("shoulder"), elbow = recipe.landmarks.at("elbow");
    const Vec3 sleeve = shoulder + recipe.sleeve_length * (elbow - shoulder);
    EXPECT_LT((centre_of(shirt, openings.left) - sleeve).norm(), 0.015);
    EXPECT_LT((centre_of(shirt, openings.right) - sleeve.cwiseProduct(Vec3(-1, 1, 1))).norm(),
              0.015);
    double widest = 0.0;
    for (int i : openings.neck) {
        widest = std::max(widest, std::abs(shirt.vertices(i, 0)));
        EXPECT_GT(shirt.vertices(i, 1), shoulder.y()) << "the neckline hangs too low";
    }
    EXPECT_LT(widest, 0.65 * shoulder.x()) << "the opening would slide off the shoulders";
}

TEST(Tshirt, HangsOneToThreeCentimetresOffChestAndWaist) {
    const TriMesh shirt = load_garment_mesh("tshirt");
    for (double height : {1.20, 1.05}) {
        double sum = 0.0, count = 0.0;
        for (Eigen::Index i = 0; i < shirt.vertices.rows(); ++i) {
            const Vec3 p = shirt.vertices.row(i);
            if (std::abs(p.y() - height) > 0.015 || std::abs(p.x()) > 0.17) continue;
            sum += default_skin().nearest(p).distance;
            count += 1.0;
        }
        EXPECT_GT(sum / count, 0.01) << "at height " << height;
        EXPECT_LT(sum / count, 0.03) << "at height " << height;
    }
}

TEST(Tshirt, IsSmoothButForTheSeamUnderTheArm) {
    const Vec3 armpit = committed_recipe("tshirt").landmarks.at("armpit");
    const Garment garment("tshirt", load_garment_mesh("tshirt"), Fabric::soft_cotton(), {}, true);
    const VectorX angles = garment.hinge_rest_angles().cwiseAbs();  // between triangles (rad)
    EXPECT_LT(angles.mean(), 0.08);
    for (size_t h = 0; h < garment.hinges().size(); ++h) {
        const Vec3 p = garment.rest().vertices.row(garment.hinges()[h][0]);
        const bool in_seam = (p.cwiseAbs() - armpit.cwiseAbs()).norm() < 0.09;
        EXPECT_LT(angles[static_cast<Eigen::Index>(h)], in_seam ? 1.0 : 0.45) << p.transpose();
    }
}

TEST(Tshirt, LoadsAsAGarmentOfAFabric) {
    const Garment shirt = load_garment("tshirt_1000", Fabric::real_cotton());
    EXPECT_EQ(shirt.name(), "tshirt_1000");
    EXPECT_EQ(shirt.fabric().mu, Fabric::real_cotton().mu);
    EXPECT_NEAR(shirt.masses().sum(), 0.2 * 0.63, 0.01) << "126 g of cloth";
    EXPECT_THROW(load_garment("no_such_garment"), LoadError);
}

TEST(MakeGarment, VertexCountsOutOfRangeAreRefused) {
    for (int vertices : {-1, 0, 499, 60001}) {
        GarmentRecipe recipe;
        recipe.target_vertices = vertices;
        EXPECT_THROW(make_garment(default_skin().surface(), {}, recipe), ArgumentError);
    }
}

TEST(GarmentRecipe, DefaultsAreTheTshirts) {
    const GarmentRecipe file = committed_recipe("tshirt");
    const GarmentRecipe defaults;
    EXPECT_EQ(file.target_vertices, defaults.target_vertices);
    EXPECT_EQ(file.from, defaults.from);
    EXPECT_EQ(file.to, defaults.to);
    EXPECT_EQ(file.neck_tilt, defaults.neck_tilt);
    EXPECT_EQ(file.neck_half_width, defaults.neck_half_width);
    EXPECT_EQ(file.neck_half_depth, defaults.neck_half_depth);
    EXPECT_EQ(file.sleeve_length, defaults.sleeve_length);
    EXPECT_EQ(file.ease, defaults.ease);
    EXPECT_EQ(file.sleeve_ease, defaults.sleeve_ease);
    EXPECT_EQ(file.drape_radius, defaults.drape_radius);
    EXPECT_EQ(file.flare, defaults.flare);
    EXPECT_EQ(file.clearance, defaults.clearance);
}

TEST(GarmentRecipe, WordsSayWhatItCovers) {
    const GarmentRecipe pants = committed_recipe("pants");
    EXPECT_EQ(pants.from, GarmentRecipe::From::waist);
    EXPECT_EQ(pants.to, GarmentRecipe::To::legs);
    EXPECT_EQ(committed_recipe("dress").sleeve_length, 0.0);
}

TEST(GarmentRecipe, BrokenRecipesAreRefusedByField) {
    EXPECT_THROW(load_garment_recipe("/no/such/recipe.json"), LoadError);
    const std::pair<const char*, const char*> cases[] = {
        {"", "JSON"},
        {"[1, 2]", "not a JSON object"},
        {"{\"hem_height\": 0.8", "JSON"},
        {"{\"hemline\": 0.8}", "field hemline: there is no such field"},
        {"{\"hem_height\": \"low\"}", "field hem_height: it is not a number"},
        {"{\"hem_height\": 81}", "field hem_height: 81 is out of range"},
        {"{\"from\": \"feet\"}", "field from: \"feet\" is not one of its words"},
        {"{\"to\": 2}", "field to: 2 is not one of its words"},
        {"{\"sleeve_length\": 0.1}", "field sleeve_length: 0.1 is out of range"},
        {"{\"to\": \"legs\", \"hem\": 0.2}", "field hem: 0.2 is out of range"},
        {"{\"hem_height\": null}", "field hem_height: it is not a number"},
        {"{\"elbow\": [0, 1]}", "field elbow: it is not a list of three numbers"},
        {"{\"elbow\": [0, 1, null]}", "field elbow: it is not a number"},
        {"{\"target_vertices\": 10}", "field target_vertices"},
    };
    for (const auto& [text, part] : cases) {
        const std::string error = recipe_error("garment_test_recipe.json", text);
        EXPECT_NE(error.find(part), std::string::npos) << error;
    }
}

TEST(SurfaceDistance, MatchesTheBruteForceOracleAndTheClosedForm) {
    const TriMesh mesh = ball(0.3);
    const SurfaceDistance surface(mesh);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-0.45, 0.45);
    for (int n = 0; n < 300; ++n) {
        const Vec3 p(uniform(random), uniform(random), uniform(random));
        const NearestPoint near = surface.nearest(p);
        EXPECT_NEAR(near.distance, p.norm() - 0.3, 0.005);
        double nearest_sample = std::numeric_limits<double>::infinity();
        for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
            for (const Vec3& w : {Vec3(1, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0.2, 0.3, 0.5)}) {
                Vec3 q = Vec3::Zero();
                for (int c = 0; c < 3; ++c) q += w[c] * mesh.vertices.row(mesh.faces(f, c));
                nearest_sample = std::min(nearest_sample, (q - p).norm());
            }
        EXPECT_LE(std::abs(near.distance), nearest_sample + 1e-12);
        Vec3 rebuilt = Vec3::Zero();
        for (int c = 0; c < 3; ++c)
            rebuilt += near.weights[c] * mesh.vertices.row(mesh.faces(near.face, c));
        EXPECT_LT((rebuilt - near.point).norm(), 1e-12);
    }
}

TEST(SurfaceDistance, SignIsRightBesideSharpEdgesAndBeyondTheRadiusThereIsNothing) {
    TriMesh wedge;  // a thin tetrahedron: face normals alone would get the sign wrong
    wedge.vertices.resize(4, 3);
    wedge.vertices << 0, 0, 0, 1, 0, 0, 0.5, 0.02, 1, 0.5, -0.02, 1;
    wedge.faces.resize(4, 3);
    wedge.faces << 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3;
    const SurfaceDistance surface(wedge);
    const Vec3 outside[] = {{0.5, 0, -0.1}, {-0.1, 0, 0}, {0.5, 0.3, 0.5}, {0.5, 0, 1.2}};
    for (const Vec3& p : outside) EXPECT_GT(surface.nearest(p).distance, 0.0) << p.transpose();
    EXPECT_LT(surface.nearest({0.5, 0, 0.8}).distance, 0.0);
    EXPECT_FALSE(surface.nearest_within(1.0, {0, 5, 0}));
    ASSERT_TRUE(surface.nearest_within(5.1, {0, 5, 0}));
    EXPECT_EQ(surface.nearest_within(5.1, {0, 5, 0})->point, surface.nearest({0, 5, 0}).point);
}

TEST(ScalarGrid, BallIsClosedOutwardAndOfTheRightVolume) {
    const TriMesh mesh = ball(0.3, 0.03);
    const Topology shape = topology(mesh.faces);
    EXPECT_TRUE(shape.manifold && shape.oriented);
    EXPECT_EQ(shape.boundary_loops, 0);
    EXPECT_EQ(shape.euler_characteristic, 2);
    double volume = 0.0;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        const Vec3 a = mesh.vertices.row(mesh.faces(f, 0)), b = mesh.vertices.row(mesh.faces(f, 1)),
                   c = mesh.vertices.row(mesh.faces(f, 2));
        volume += a.dot(b.cross(c)) / 6.0;
    }
    EXPECT_NEAR(volume, 4.0 / 3.0 * M_PI * std::pow(0.3, 3), 0.002);
}

TEST(SurfaceEdit, CutLeavesAStraightBorderAndComponentsAreChosenByPlace) {
    const TriMesh sheet = make_sheet(1.0, 1.0, 200);
    const VectorX level = sheet.vertices.col(0).cwiseAbs().array() * -1.0 + 0.2;  // two strips
    const TriMesh strips = cut_surface(sheet, level);
    EXPECT_EQ(topology(strips.faces).components, 2);
    const TriMesh left = keep_component(strips, Vec3(-0.4, 0, 0));
    EXPECT_EQ(topology(left.faces).components, 1);
    EXPECT_NEAR(left.vertices.col(0).maxCoeff(), -0.2, 0.01);
    EXPECT_NEAR(face_area_vectors(left.vertices, left.faces).col(1).sum(), 0.3, 0.01);
}

TEST(SurfaceEdit, RemeshedBowlKeepsItsBorderAndItsShape) {
    const TriMesh sphere = ball(0.3, 0.03);
    const TriMesh bowl = cut_surface(sphere, sphere.vertices.col(1));
    const TriMesh mesh = remesh(bowl, 400);
    EXPECT_NEAR(static_cast<double>(mesh.vertices.rows()), 400.0, 12.0);
    EXPECT_GT(smallest_angle(mesh), 20.0);
    const auto loops = boundary_loops(mesh.faces);
    ASSERT_EQ(loops.size(), 1u);
    for (int i : loops[0]) EXPECT_NEAR(mesh.vertices(i, 1), 0.0, 2e-3);
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i)
        EXPECT_NEAR(mesh.vertices.row(i).norm(), 0.3, 0.004);
}

TEST(EdgeFlips, SliversBecomeGoodTriangles) {
    TriMesh quad;
    quad.vertices.resize(6, 3);
    quad.vertices << 0, 0, 0, 1, 0.1, 0, 0, 0.2, 0, -1, 0.1, 0, 0, -1, 0, 0, 1.2, 0;
    quad.faces.resize(6, 3);
    quad.faces << 3, 1, 2, 1, 3, 0, 0, 4, 1, 3, 4, 0, 1, 5, 2, 2, 5, 3;
    const double area = face_area_vectors(quad.vertices, quad.faces).col(2).sum();
    const double before = smallest_angle(quad);
    EXPECT_EQ(flip_edges(quad), 1);
    EXPECT_GT(smallest_angle(quad), before);
    EXPECT_NEAR(face_area_vectors(quad.vertices, quad.faces).col(2).sum(), area, 1e-12);
    EXPECT_TRUE(topology(quad.faces).oriented);
    EXPECT_EQ(flip_edges(quad), 0);
}

TEST(EdgeFlips, AVertexSqueezedAgainstTheBorderIsFreed) {
    TriMesh mesh;  // 3 is inside, between 0, 1 and 2 of the border
    mesh.vertices.resize(5, 3);
    mesh.vertices << -1, 0, 0, 0, -0.1, 0, 1, 0, 0, 0, -0.05, 0, 0, 1.2, 0;
    mesh.faces.resize(4, 3);
    mesh.faces << 0, 1, 3, 1, 2, 3, 0, 3, 2, 0, 2, 4;
    EXPECT_EQ(flip_edges(mesh), 1);
    EXPECT_TRUE(topology(mesh.faces).oriented);
    EXPECT_EQ(topology(mesh.faces).boundary_loops, 1);
    EXPECT_EQ(undirected_edges(mesh.faces).size(), 8u);
    int faces_of_the_vertex = 0;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        faces_of_the_vertex += (mesh.faces.row(f).array() == 3).any() ? 1 : 0;
    EXPECT_EQ(faces_of_the_vertex, 4);
}

TEST(Clearance, SheetThroughABallIsPushedOut) {
    const SurfaceDistance body(ball(0.3, 0.02));
    TriMesh sheet = make_sheet(1.0, 1.0, 900);
    sheet.vertices.col(1).array() += 0.28;  // 2 cm inside the top of the ball
    EXPECT_LT(smallest_clearance(sheet, body), -0.01);
    EXPECT_GE(push_out(sheet, body, 0.004), 0.004);
    EXPECT_GE(smallest_clearance(sheet, body), 0.004);
    EXPECT_LT(sheet.vertices.col(1).maxCoeff(), 0.32) << "no spikes";
}

}  // namespace cloth::garment_test
