#include "data/authoring/garment_import.h"

#include <gtest/gtest.h>

#include <limits>

#include "data/authoring/seams.h"
#include "data/authoring/surface_edit.h"
#include "data/authoring/waistband.h"
#include "data/core/errors.h"
#include "tests/data/authoring/broken_garments.h"
#include "tests/data/authoring/garment_checks.h"
#include "tests/test_meshes.h"

namespace cloth::garment_import_test {

using namespace cloth::test;

namespace {

const SurfaceDistance& skin() {
    static const SurfaceDistance distance{person()};
    return distance;
}

GarmentImport imported(const TriMesh& mesh, const GarmentImportSettings& settings = {}) {
    return import_garment(mesh, person(), settings);
}

/// What holds for every garment that is made.
void expect_wearable(const ImportedGarment& garment) {
    validate_mesh("garment", garment.worn);
    const Topology shape = topology(garment.worn.faces);
    EXPECT_TRUE(shape.manifold);
    EXPECT_TRUE(shape.oriented);
    EXPECT_EQ(garment.inside, 0.0);
    EXPECT_GE(smallest_clearance(garment.worn, skin()), 0.004);
    EXPECT_EQ(garment.rest.rows(), garment.worn.vertices.rows());
}

bool says(const std::vector<std::string>& lines, const std::string& part) {
    for (const std::string& line : lines)
        if (line.find(part) != std::string::npos) return true;
    return false;
}

std::string refusal(const TriMesh& mesh, const TriMesh& on = person()) {
    try {
        import_garment(mesh, on);
    } catch (const ArgumentError& error) {
        return error.what();
    }
    return "";
}

/// A square sheet with a round hole in its middle, level with its faces upwards: a poncho.
TriMesh sheet_with_hole(double height, double half, double hole) {
    constexpr int n = 32;
    TriMesh sheet{Points((n + 1) * (n + 1), 3), {}};
    for (int i = 0; i <= n; ++i)
        for (int k = 0; k <= n; ++k)
            sheet.vertices.row(i * (n + 1) + k) << half * (2.0 * i / n - 1.0), height,
                half * (2.0 * k / n - 1.0);
    std::vector<std::array<int, 3>> faces;
    const auto add = [&](int a, int b, int c) {
        double nearest = 1e9;
        for (const int v : {a, b, c})
            nearest = std::min(nearest, std::hypot(sheet.vertices(v, 0), sheet.vertices(v, 2)));
        if (nearest >= hole) faces.push_back({a, b, c});
    };
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) {
            const int a = i * (n + 1) + k, b = a + n + 1;
            add(a, a + 1, b);
            add(a + 1, b + 1, b);
        }
    sheet.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
    for (size_t f = 0; f < faces.size(); ++f)
        sheet.faces.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
    return sheet;
}

/// A strip around the back of the neck, both of whose ends hang down the chest: a scarf.
TriMesh long_scarf(double neck_height) {
    std::vector<Vec3> middle;
    for (int k = 0; k < 20; ++k) middle.emplace_back(0.12, neck_height - 0.4 + 0.02 * k, 0.2);
    for (int k = 0; k <= 20; ++k) {
        const double angle = M_PI * k / 20;
        middle.emplace_back(0.12 * std::cos(angle), neck_height, 0.2 - 0.33 * std::sin(angle));
    }
    for (int k = 0; k < 20; ++k) middle.emplace_back(-0.12, neck_height - 0.02 * (k + 1), 0.2);
    constexpr int columns = 5;
    const int rows = static_cast<int>(middle.size());
    TriMesh scarf{Points(rows * columns, 3), Faces(2 * (rows - 1) * (columns - 1), 3)};
    int f = 0;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            const Vec3 at = middle[static_cast<size_t>(r)];
            Vec3 side(at.x(), 0.0, r < 20 || r > rows - 21 ? 0.0 : at.z() - 0.03);
            scarf.vertices.row(r * columns + c) = at + 0.025 * c * side.normalized();
            if (r + 1 == rows || c + 1 == columns) continue;
            const int a = r * columns + c;
            scarf.faces.row(f++) << a, a + 1, a + columns;
            scarf.faces.row(f++) << a + 1, a + columns + 1, a + columns;
        }
    return scarf;
}

/// A tube around the y axis.
TriMesh tube(double low, double high, double radius, const Vec3& centre) {
    constexpr int around = 48, rows = 12;
    TriMesh mesh{Points(around * (rows + 1), 3), Faces(2 * around * rows, 3)};
    int f = 0;
    for (int r = 0; r <= rows; ++r)
        for (int k = 0; k < around; ++k) {
            const double angle = 2.0 * M_PI * k / around;
            mesh.vertices.row(r * around + k) << centre.x() + radius * std::cos(angle),
                low + (high - low) * r / rows, centre.z() + radius * std::sin(angle);
            if (r == rows) continue;
            const int a = r * around + k, b = r * around + (k + 1) % around;
            mesh.faces.row(f++) << a, a + around, b;
            mesh.faces.row(f++) << b, a + around, b + around;
        }
    return mesh;
}

TriMesh holed_person() {
    std::vector<char> keep(static_cast<size_t>(person().faces.rows()), 1);
    for (size_t f = 0; f < 50; ++f) keep[f] = 0;
    return keep_faces(person(), keep);
}

}  // namespace

TEST(GarmentImport, GarmentsOfTheWardrobeAreNamedAndHeldAsTheyAreMade) {
    using Kind = GarmentSupport::Kind;
    for (const auto& [name, sort, kind] : std::vector<std::tuple<std::string, std::string, Kind>>{
             {"tshirt_1000", "top", Kind::shoulders},
             {"tank_top_1000", "top", Kind::shoulders},
             {"long_top_1000", "top", Kind::shoulders},
             {"shirt_1000", "top", Kind::shoulders},
             {"dress_1000", "dress", Kind::shoulders},
             {"pants_1000", "trousers", Kind::waistband},
             {"shorts_1000", "trousers", Kind::waistband},
             {"skirt_1000", "skirt", Kind::waistband}}) {
        const GarmentImport import = imported(worn_garment(name));
        ASSERT_EQ(import.garments.size(), 1u) << name;
        const ImportedGarment& garment = import.garments[0];
        EXPECT_EQ(garment.support.sort, sort) << name;
        EXPECT_EQ(garment.support.kind, kind) << name;
        EXPECT_TRUE(import.changes.empty()) << name << ": " << import.changes[0];
        EXPECT_EQ(garment.inside_before, 0.0) << name;
        EXPECT_EQ(garment.worn.faces, worn_garment(name).faces) << name;
        expect_wearable(garment);
    }
}

TEST(GarmentImport, AWaistbandIsShorterAtRest) {
    const ImportedGarment skirt = imported(worn_garment("skirt_1000")).garments[0];
    const std::vector<int>& edge = skirt.support.upper_edge;
    const double worn = length_of(skirt.worn.vertices, edge), rest = length_of(skirt.rest, edge);
    EXPECT_NEAR(rest / worn, 0.7, 0.01);
    for (Eigen::Index i = 0; i < skirt.rest.rows(); ++i)
        if (skirt.rest.row(i) != skirt.worn.vertices.row(i)) {
            EXPECT_GT(skirt.rest(i, 1), skirt.support.pin_low - 0.16) << "below the band";
        }
    for (const int i : edge) {
        EXPECT_GE(skirt.worn.vertices(i, 1), skirt.support.pin_low);
        EXPECT_LE(skirt.worn.vertices(i, 1), skirt.support.pin_high);
    }
}

TEST(GarmentImport, APonchoAndAScarfKeepTheirLengths) {
    const double height = person().vertices.col(1).maxCoeff();
    for (const auto& [name, mesh] : std::vector<std::pair<std::string, TriMesh>>{
             {"poncho", sheet_with_hole(0.88 * height, 0.48, 0.1)},
             {"poncho high above", sheet_with_hole(0.95 * height, 0.48, 0.12)},
             {"long scarf", long_scarf(0.86 * height)}}) {
        const GarmentImport import = imported(mesh);
        ASSERT_EQ(import.garments.size(), 1u) << name;
        const ImportedGarment& garment = import.garments[0];
        EXPECT_EQ(garment.support.kind, GarmentSupport::Kind::shoulders)
            << name << ", landing on " << garment.support.landing_area << " m^2";
        EXPECT_EQ(garment.support.sort, "wrap") << name;
        EXPECT_EQ(garment.rest, garment.worn.vertices) << name;
        EXPECT_EQ(garment.rest_strain, 0.0) << name;
        EXPECT_FALSE(garment.support.can_be_pinned()) << name;
        EXPECT_FALSE(says(import.warnings, "stiff")) << name;
    }
}

TEST(GarmentImport, PinsThatWouldFixMostOfItAreNotProposed) {
    // Level and in front of the body: nothing is below it that could hold it.
    TriMesh sheet = sheet_with_hole(1.0, 0.2, 0.0);
    sheet.vertices.col(2).array() += 0.4;
    const GarmentImport import = imported(sheet);
    const GarmentSupport& support = import.garments[0].support;
    EXPECT_EQ(support.kind, GarmentSupport::Kind::pins);
    EXPECT_EQ(support.pinned_share, 1.0);
    EXPECT_FALSE(support.can_be_pinned());
    EXPECT_TRUE(says(import.warnings, "would fix 100 % of its vertices. Remedy: paint goals"));
}

TEST(GarmentImport, AWaistbandThatIsTooLongIsSaidWithALengthThatHolds) {
    const Vec3 waist =
        centre_of(worn_garment("skirt_1000"),
                  imported(worn_garment("skirt_1000")).garments[0].support.upper_edge);
    const double round = imported(worn_garment("skirt_1000")).garments[0].support.waist_girth;
    EXPECT_GT(round, 0.5);
    EXPECT_LT(round, 1.1);
    const TriMesh wide = tube(waist.y() - 0.4, waist.y(), 1.6 * round / (2.0 * M_PI), waist);
    const GarmentImport import = imported(wide);
    const ImportedGarment& skirt = import.garments[0];
    ASSERT_EQ(skirt.support.kind, GarmentSupport::Kind::waistband);
    EXPECT_NEAR(skirt.support.waist_girth / round, 1.0, 0.03);
    EXPECT_NEAR(skirt.support.edge_length / round, 1.6, 0.03);
    EXPECT_TRUE(says(import.warnings, "skirt: it slides down. Its waistband is"));
    EXPECT_TRUE(says(import.warnings, "Remedy: --band-ratio 0.5")) << import.warnings.size();
    GarmentImportSettings settings;
    settings.band_ratio = 0.55;
    EXPECT_FALSE(says(imported(wide, settings).warnings, "slides down"));
    // So far from the body, its upper edge is no waistband.
    const TriMesh away = tube(waist.y() - 0.4, waist.y(), 2.2 * round / (2.0 * M_PI), waist);
    EXPECT_EQ(imported(away).garments[0].support.kind, GarmentSupport::Kind::pins);
}

TEST(GarmentImport, WithABandRatioOfOneThereIsNoWaistband) {
    GarmentImportSettings settings;
    settings.band_ratio = 1.0;
    const GarmentImport import = imported(worn_garment("skirt_1000"), settings);
    const ImportedGarment& skirt = import.garments[0];
    EXPECT_EQ(skirt.support.kind, GarmentSupport::Kind::pins);
    EXPECT_EQ(skirt.support.sort, "skirt");
    EXPECT_TRUE(skirt.support.can_be_pinned());
    EXPECT_EQ(skirt.rest, skirt.worn.vertices);
    EXPECT_TRUE(says(import.warnings, "nothing holds it. Remedy: --pin"));
}

TEST(GarmentImport, TheNumberOfVerticesThatIsProposedMakesEdgesOf20Millimetres) {
    GarmentImportSettings coarse;
    coarse.vertices = 500;
    const GarmentImport import = imported(worn_garment("dress_1000"), coarse);
    std::string warning;
    for (const std::string& line : import.warnings)
        if (line.find("Remedy: --vertices ") != std::string::npos) warning = line;
    ASSERT_NE(warning, "");
    GarmentImportSettings proposed;
    proposed.vertices = std::stoi(warning.substr(warning.rfind(' ') + 1));
    EXPECT_GT(proposed.vertices, 1000);
    EXPECT_NEAR(imported(worn_garment("dress_1000"), proposed).garments[0].edge_length, 0.02,
                0.002);
}

TEST(GarmentImport, MessagesNameTheFilesThatTheyAreAbout) {
    GarmentImportSettings settings;
    settings.garment_name = "skirt.obj";
    settings.skin_name = "dancer.glb";
    const TriMesh skirt = worn_garment("skirt_1000");
    for (const auto& [mesh, on, name] : std::vector<std::tuple<TriMesh, TriMesh, std::string>>{
             {{skirt.vertices, Faces(0, 3)}, person(), "skirt.obj: "},
             {scaled(skirt, 3.0), person(), "skirt.obj: "},
             {skirt, turned(person()), "dancer.glb: "}})
        try {
            import_garment(mesh, on, settings);
            ADD_FAILURE() << "it was taken";
        } catch (const ArgumentError& error) {
            EXPECT_EQ(std::string(error.what()).rfind(name, 0), 0u) << error.what();
        }
}

TEST(GarmentImport, WhatIsInsideIsLedOut) {
    TriMesh shirt = worn_garment("tshirt_1000");
    shirt.vertices -= 0.02 * vertex_normals(shirt.vertices, shirt.faces);
    const ImportedGarment garment =
        imported(shirt, {1e-4, 4.5e-3, /*most_inside=*/1.0}).garments[0];
    EXPECT_GT(garment.inside_before, 0.3);
    EXPECT_GT(garment.deepest_before, 0.005);
    EXPECT_GT(garment.angle, 8.0);
    expect_wearable(garment);
}

TEST(GarmentImport, DefectsAreMendedAndSaid) {
    const TriMesh shirt = worn_garment("tshirt_1000");
    struct Case {
        const char* name;
        TriMesh mesh;
        std::string said;
    };
    TriMesh mixed = shirt;
    for (Eigen::Index f = 0; f < 30; ++f) std::swap(mixed.faces(f, 1), mixed.faces(f, 2));
    TriMesh twice = together(shirt, shirt);
    const Vec3 middle =
        0.5 * (shirt.vertices.row(shirt.faces(0, 0)) + shirt.vertices.row(shirt.faces(0, 1)));
    const TriMesh flat = with_fin(shirt, shirt.faces(0, 0), shirt.faces(0, 1), middle);
    TriMesh button = scaled(shirt, 0.02);
    button.vertices.rowwise() += Eigen::RowVector3d(0, 1.2, 0.25);
    for (const Case& test :
         std::vector<Case>{{"inside out", turned(shirt), "inside out"},
                           {"some turned", mixed, "30 faces were turned"},
                           {"unwelded", cut_in_two(shirt, 5e-5), "were joined"},
                           {"twice", twice, "there twice"},
                           {"without area", flat, "without area"},
                           {"button", together(shirt, button), "small pieces"},
                           {"thick", thick(shirt, 0.002), "shell, 2.0 mm thick"}}) {
        const GarmentImport import = imported(test.mesh);
        ASSERT_EQ(import.garments.size(), 1u) << test.name;
        const auto& lines = import.changes;
        EXPECT_TRUE(says(lines, test.said))
            << test.name << ": " << (lines.empty() ? "nothing" : lines[0]);
        expect_wearable(import.garments[0]);
        EXPECT_EQ(import.garments[0].support.sort, "top") << test.name;
        EXPECT_NEAR(static_cast<double>(import.garments[0].worn.faces.rows()),
                    static_cast<double>(shirt.faces.rows()), 20.0)
            << test.name;
    }
}

TEST(GarmentImport, WhatMayGoWrongIsSaidWithARemedy) {
    const TriMesh shirt = worn_garment("tshirt_1000");
    const GarmentImport open = imported(cut_in_two(shirt, 1.5e-3));
    EXPECT_TRUE(says(open.warnings, "--weld 0.002")) << open.warnings.size();
    const Vec3 tip = shirt.vertices.row(shirt.faces(0, 0)) + Eigen::RowVector3d(0, 0.01, 0.2);
    const TriMesh fin = with_fin(shirt, shirt.faces(0, 0), shirt.faces(0, 1), tip);
    EXPECT_TRUE(says(imported(fin).warnings, "more than two faces"));
    EXPECT_TRUE(says(import_garment(shirt, holed_person()).warnings, "not closed"));
}

TEST(GarmentImport, WhatCannotBeUsedIsRefusedWithARemedy) {
    const TriMesh shirt = worn_garment("tshirt_1000");
    TriMesh nan = shirt;
    nan.vertices(17, 1) = std::numeric_limits<double>::quiet_NaN();
    TriMesh line = shirt;
    line.vertices.leftCols(2).setZero();
    TriMesh strip = moebius(60);
    strip.vertices.rowwise() += Eigen::RowVector3d(0, 1.1, 0);
    TriMesh within = shirt;
    within.vertices -= 0.04 * vertex_normals(shirt.vertices, shirt.faces);
    TriMesh away = shirt;
    away.vertices.col(2).array() += 0.7;
    TriMesh beside = shirt;
    beside.vertices.col(2).array() += 0.12;
    for (const auto& [mesh, on, part] : std::vector<std::tuple<TriMesh, TriMesh, std::string>>{
             {{shirt.vertices, Faces(0, 3)}, person(), "no faces"},
             {nan, person(), "vertex 17 is not finite"},
             {line, person(), "no face with an area"},
             {strip, person(), "one side only"},
             {within, person(), "inside the skin"},
             {beside, person(), "led out of the skin"},
             {away, person(), "m from the skin"},
             {shirt, turned(person()), "character: it is inside out"},
             {shirt, {person().vertices, Faces(0, 3)}, "character"}}) {
        const std::string message = refusal(mesh, on);
        EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
        EXPECT_NE(message.find("Remedy: "), std::string::npos) << message;
    }
}

TEST(GarmentImport, PiecesBecomeGarmentsOrOne) {
    const TriMesh both = together(worn_garment("tshirt_1000"), worn_garment("pants_1000"));
    const GarmentImport import = imported(both);
    ASSERT_EQ(import.garments.size(), 2u);
    EXPECT_EQ(import.garments[0].support.sort, "trousers");
    EXPECT_EQ(import.garments[1].support.sort, "top");
    EXPECT_LT(height_over(import.garments[1].worn, import.garments[1].worn, skin()), 1e-9);
    GarmentImportSettings settings;
    settings.together = true;
    const GarmentImport suit = imported(both, settings);
    ASSERT_EQ(suit.garments.size(), 1u);
    // The shirt hangs from the shoulders; the trousers have to be held all the same.
    const ImportedGarment& garment = suit.garments[0];
    EXPECT_EQ(garment.support.sort, "suit");
    ASSERT_EQ(garment.piece_support.size(), 2u);
    EXPECT_EQ(garment.piece_support[0].kind, GarmentSupport::Kind::shoulders);
    EXPECT_EQ(garment.piece_support[1].kind, GarmentSupport::Kind::waistband);
    const std::vector<int>& edge = garment.support.upper_edge;
    EXPECT_NEAR(length_of(garment.rest, edge) / length_of(garment.worn.vertices, edge), 0.7, 0.01);
    const Eigen::Index shirt = worn_garment("tshirt_1000").vertices.rows();
    EXPECT_EQ(garment.rest.topRows(shirt), garment.worn.vertices.topRows(shirt));
}

TEST(GarmentImport, RemeshesOnRequest) {
    GarmentImportSettings settings;
    settings.vertices = 2000;
    const ImportedGarment garment = imported(worn_garment("skirt_1000"), settings).garments[0];
    EXPECT_NEAR(static_cast<double>(garment.worn.vertices.rows()), 2000.0, 60.0);
    EXPECT_EQ(garment.vertices_before, 1002);
    EXPECT_GT(smallest_angle(garment.worn), 12.0);
    EXPECT_EQ(garment.support.sort, "skirt");
    expect_wearable(garment);
}

TEST(Remesh, DoesNotTakeABorderThatSlidForAFold) {
    // Flat before and behind: the vertices of its borders are not equally far apart.
    TriMesh skirt = tube(0.45, 1.0, 0.2, Vec3::Zero());
    for (auto x : skirt.vertices.rowwise()) {
        const double flare = 1.0 + 0.9 * (1.0 - x.y()) / 0.55;
        x.x() *= flare;
        x.z() *= 0.4 * flare;
    }
    for (const TriMesh& garment : {skirt, worn_garment("skirt_1000"), worn_garment("pants_1000")})
        for (const int vertices : {1500, 2000, 2500, 3000})
            EXPECT_GT(smallest_angle(remesh(garment, vertices, {}, Folds::keep)), 12.0) << vertices;
}

TEST(GarmentImport, ACapeIsHeldByPins) {
    TriMesh cape = load_garment_mesh("cape");
    cape.vertices.rowwise() += Eigen::RowVector3d(0, 0.95, 0.05);
    const GarmentImport import = imported(cape);
    EXPECT_EQ(import.garments[0].support.kind, GarmentSupport::Kind::pins);
    EXPECT_TRUE(says(import.warnings, "nothing holds it"));
}

TEST(GarmentImport, ShoesAndHatsAreSaidToBeStiff) {
    const auto box_of = [](auto&& belongs) {
        Eigen::RowVector3d low = Eigen::RowVector3d::Constant(1e9), high = -low;
        for (const auto& x : person().vertices.rowwise())
            if (belongs(x)) low = low.cwiseMin(x), high = high.cwiseMax(x);
        return std::pair(low, high);
    };
    // A ball around a part of the body, open on one side.
    const auto ball_around = [](const auto& box, auto&& keeps) {
        TriMesh ball = icosphere(3);
        ball.vertices.array().rowwise() *= 0.9 * (box.second - box.first).array();
        ball.vertices.rowwise() += 0.5 * (box.first + box.second);
        std::vector<char> keep;
        for (Eigen::Index f = 0; f < ball.faces.rows(); ++f)
            keep.push_back(keeps(ball.vertices(ball.faces(f, 0), 1)));
        return keep_faces(ball, keep);
    };
    const auto left = box_of([](const auto& x) { return x.y() < 0.1 && x.x() > 0; });
    const auto right = box_of([](const auto& x) { return x.y() < 0.1 && x.x() < 0; });
    const auto low = [](double y) { return y < 0.1; };
    const GarmentImport shoes = imported(together(ball_around(left, low), ball_around(right, low)));
    EXPECT_EQ(shoes.garments.size(), 2u);
    EXPECT_EQ(shoes.garments[0].support.sort, "shoes");
    EXPECT_TRUE(says(shoes.warnings, "stiff"));
    const GarmentImport hat = imported(ball_around(
        box_of([](const auto& x) { return x.y() > 1.5; }), [](double y) { return y > 1.55; }));
    EXPECT_EQ(hat.garments[0].support.sort, "hat");
    EXPECT_TRUE(says(hat.warnings, "a hat is stiff"));
}

TEST(GarmentImport, IsTheSameEveryTime) {
    GarmentImportSettings settings;
    settings.vertices = 800;
    const TriMesh mesh = thick(worn_garment("skirt_1000"), 0.002);
    const ImportedGarment a = imported(mesh, settings).garments[0];
    const ImportedGarment b = imported(mesh, settings).garments[0];
    EXPECT_EQ(a.rest, b.rest);
    EXPECT_EQ(a.worn.faces, b.worn.faces);
}

TEST(Seams, TheSmallestToleranceThatClosesThemIsFound) {
    const TriMesh shirt = worn_garment("tshirt_1000");
    EXPECT_EQ(find_open_seams(shirt).vertices, 0);
    for (const double gap : {1.5e-4, 8e-4, 2.5e-3}) {
        const OpenSeams seams = find_open_seams(cut_in_two(shirt, gap));
        EXPECT_GT(seams.vertices, 20) << gap;
        EXPECT_GE(seams.tolerance, gap);
        EXPECT_LE(seams.tolerance, 3.4 * gap);
    }
}

TEST(Remesh, KeepsFoldsIfItIsTold) {
    // A strip that is folded over by 170 degrees along x = 0.
    constexpr int columns = 21, rows = 41;
    TriMesh strip{Points(rows * columns, 3), Faces(2 * (rows - 1) * (columns - 1), 3)};
    int f = 0;
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            const double s = 0.02 * (c - 10);
            strip.vertices.row(r * columns + c) << -std::abs(s), (s > 0 ? 0.17 * s : 0.0), 0.02 * r;
            if (r + 1 == rows || c + 1 == columns) continue;
            const int a = r * columns + c;
            strip.faces.row(f++) << a, a + columns, a + 1;
            strip.faces.row(f++) << a + 1, a + columns, a + columns + 1;
        }
    const auto farthest = [&](Folds folds) {
        return remesh(strip, 600, {}, folds).vertices.col(0).maxCoeff();
    };
    EXPECT_GT(farthest(Folds::keep), -1e-3);
    const TriMesh kept = remesh(strip, 600, {}, Folds::keep);
    int along = 0;
    for (Eigen::Index i = 0; i < kept.vertices.rows(); ++i) along += kept.vertices(i, 0) > -2e-3;
    EXPECT_GT(along, 15) << "the fold's line has vertices from end to end";
}

TEST(Waistband, FollowsAnEdgeThatIsNotLevel) {
    const TriMesh skirt = worn_garment("skirt_1000");
    const std::vector<int> edge = imported(skirt).garments[0].support.upper_edge;
    TriMesh slanted = skirt;
    slanted.vertices.col(1) += 0.1 * slanted.vertices.col(2);
    const Points rest = without_stretch(slanted.vertices, edge, 0.04, 0.8);
    EXPECT_NEAR(length_of(rest, edge) / length_of(slanted.vertices, edge), 0.8, 0.02);
    EXPECT_EQ(rest.col(1), slanted.vertices.col(1)) << "heights stay";
}

}  // namespace cloth::garment_import_test
