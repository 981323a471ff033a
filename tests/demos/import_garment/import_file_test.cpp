#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "data/authoring/garment_support.h"
#include "data/body/body_shapes.h"
#include "data/body/outfit.h"
#include "data/files/painted_mesh.h"
#include "demos/bake/character_scene.h"
#include "demos/compare/arguments.h"
#include "demos/import_garment/import.h"
#include "tests/data/authoring/broken_garments.h"
#include "tests/data/files/file_fixture.h"

namespace cloth::import_file_test {

using namespace cloth::test;

namespace {

/// A square of 1 m behind the person.
TriMesh sheet_on_the_floor() {
    constexpr int n = 20;
    TriMesh sheet{Points((n + 1) * (n + 1), 3), Faces(2 * n * n, 3)};
    for (int i = 0; i <= n; ++i)
        for (int k = 0; k <= n; ++k)
            sheet.vertices.row(i * (n + 1) + k) << double(i) / n - 0.5, 0.02, -0.2 - double(k) / n;
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) {
            const int a = i * (n + 1) + k, f = 2 * (i * n + k);
            sheet.faces.row(f) << a, a + 1, a + n + 2;
            sheet.faces.row(f + 1) << a, a + n + 2, a + n + 1;
        }
    return sheet;
}

class ImportFile : public FileTest {
 protected:
    /// The file that holds a mesh, and options for it.
    ImportOptions options_for(const TriMesh& mesh, const std::string& name = "thing.obj") const {
        save_obj(path(name), mesh);
        return options_for(name);
    }
    ImportOptions options_for(const std::string& name,
                              const std::vector<std::string>& more = {}) const {
        std::vector<std::string> arguments{path(name), "--out", path("out"), "--no-picture"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return parse_import_options(arguments);
    }
    std::string refusal(const ImportOptions& options) const {
        try {
            import_file(options);
        } catch (const std::exception& error) {
            EXPECT_FALSE(std::filesystem::exists(path("out"))) << "something was written";
            return error.what();
        }
        return "no error";
    }
};

}  // namespace

TEST_F(ImportFile, WhatIsWrittenIsAGarmentOfTheProject) {
    ImportOptions options = options_for(worn_garment("skirt_1000"));
    options.picture = true;
    const ImportResult result = import_file(options);
    ASSERT_EQ(result.files.size(), 1u);
    const Outfit outfit = load_outfit(result.files[0]);
    EXPECT_EQ(outfit.garment.vertex_count(), 1002);
    EXPECT_GT((outfit.start.x - outfit.garment.rest().vertices).norm(), 0.01) << "a waistband";
    for (const char* file :
         {"thing.obj", "thing.worn.obj", "thing.import.json", "thing.import.txt"})
        EXPECT_TRUE(std::filesystem::exists(path("out/") + file)) << file;
    EXPECT_GT(std::filesystem::file_size(path("out/thing.import.png")), 10000u);
    const auto& garment = result.json.at("garments").at(0);
    EXPECT_EQ(garment.at("sort"), "skirt");
    EXPECT_EQ(garment.at("held_by"), "waistband");
    EXPECT_EQ(garment.at("vertices"), 1002);
    EXPECT_EQ(garment.at("part_inside"), 0.0);
    EXPECT_GT(garment.at("pins").at("high_m"), garment.at("pins").at("low_m"));
    std::ifstream file(path("out/thing.import.json"));
    EXPECT_EQ(nlohmann::ordered_json::parse(file), result.json);
    EXPECT_NE(result.text.find("compare --garment " + result.files[0]), std::string::npos);
}

TEST_F(ImportFile, GoalsThatArePaintedAreCarriedOver) {
    const TriMesh shirt = worn_garment("tshirt_1000");
    GoalLimits limits;
    limits.max_distance = (0.5 * (shirt.vertices.col(1).array() - 0.8)).max(0.0);
    save_painted_ply(path("shirt.ply"), shirt, limits);
    const ImportResult result = import_file(options_for("shirt.ply", {"--vertices", "700"}));
    ASSERT_EQ(result.files.size(), 1u);
    EXPECT_EQ(result.files[0], path("out/shirt.ply"));
    EXPECT_NE(result.text.find("goals that are painted on it were carried over"),
              std::string::npos);
    const PaintedMesh made = load_painted_mesh(result.files[0]);
    EXPECT_LT(made.mesh.vertices.rows(), 800);
    ASSERT_EQ(made.limits.max_distance.size(), made.mesh.vertices.rows());
    for (Eigen::Index i = 0; i < made.mesh.vertices.rows(); ++i)
        EXPECT_NEAR(made.limits.max_distance[i],
                    std::max(0.0, 0.5 * (made.mesh.vertices(i, 1) - 0.8)), 0.01)
            << i;
    EXPECT_EQ(load_outfit(result.files[0]).garment.vertex_count(), made.mesh.vertices.rows());
}

TEST_F(ImportFile, OptionsThatMoveItAwayAreToBeLeftOut) {
    const TriMesh shirt = worn_garment("tshirt_1000");
    save_obj(path("thing.obj"), shirt);
    TriMesh large = shirt;
    large.vertices *= 100.0;
    save_obj(path("large.obj"), large);
    const std::pair<ImportOptions, std::string> cases[] = {
        {options_for("thing.obj", {"--move", "0", "5", "0"}),
         "Remedy: leave --move out if the file is in metres"},
        {options_for("thing.obj", {"--up", "z"}),
         "Remedy: leave --up out if the file is in metres"},
        {options_for("thing.obj", {"--up", "z", "--move", "0", "5", "0"}),
         "Remedy: leave --up and --move out if the file is in metres"},
        {options_for("large.obj", {"--move", "0", "5", "0"}),
         "Remedy: --unit cm and leave --move out if the file is in centimetres"}};
    for (const auto& [options, remedy] : cases)
        EXPECT_NE(refusal(options).find(remedy), std::string::npos) << refusal(options);
}

TEST_F(ImportFile, PiecesAreFilesAndAnOutfitFromTheOutside) {
    const ImportResult result =
        import_file(options_for(together(worn_garment("pants_1000"), worn_garment("shirt_1000"))));
    ASSERT_EQ(result.files.size(), 2u);
    const std::string outfit = path("out/thing_top.obj") + "+" + path("out/thing_trousers.obj");
    EXPECT_NE(result.text.find(outfit), std::string::npos) << result.text;
    EXPECT_EQ(load_outfit(outfit).part_count(), 2);
}

TEST_F(ImportFile, ASuitInOnePieceIsReportedPieceByPiece) {
    save_obj(path("suit.obj"), together(worn_garment("pants_1000"), worn_garment("tshirt_1000")));
    const ImportResult result = import_file(options_for("suit.obj", {"--together"}));
    ASSERT_EQ(result.files.size(), 1u);
    EXPECT_TRUE(std::filesystem::exists(path("out/suit.worn.obj")));
    EXPECT_NE(result.text.find("held by      top: it hangs from the shoulders"), std::string::npos);
    EXPECT_NE(result.text.find("held by      trousers: a waistband"), std::string::npos);
    EXPECT_NE(result.text.find("% shorter at rest; the waist is"), std::string::npos)
        << result.text;
    const auto& garment = result.json.at("garments").at(0);
    EXPECT_EQ(garment.at("pieces").size(), 2u);
    EXPECT_LT(garment.at("waistband_strain"), -0.29);
}

TEST_F(ImportFile, WhatTheImporterRefusesNamesTheFile) {
    TriMesh beside = worn_garment("tshirt_1000");
    beside.vertices.col(2).array() += 0.12;
    const std::string message = refusal(options_for(beside));
    EXPECT_EQ(message.rfind(path("thing.obj") + ": ", 0), 0u) << message;
}

TEST_F(ImportFile, WrongScalesAxesAndPlacesAreSaidWithTheOptionThatMendsThem) {
    const TriMesh shirt = worn_garment("tshirt_1000");
    TriMesh z_up = shirt;
    z_up.vertices.col(1) = -100.0 * shirt.vertices.col(2);
    z_up.vertices.col(2) = 100.0 * shirt.vertices.col(1);
    z_up.vertices.col(0) *= 100.0;
    TriMesh away = shirt;
    away.vertices.col(1).array() += 5.0;
    struct Case {
        TriMesh mesh;
        std::string remedy;
        std::vector<std::string> mends;
    };
    for (const Case& test :
         std::vector<Case>{{scaled(shirt, 100.0), "--unit cm", {"--unit", "cm"}},
                           {scaled(shirt, 1000.0), "--unit mm", {"--unit", "mm"}},
                           {scaled(shirt, 10.0), "--unit dm", {"--unit", "dm"}},
                           {z_up, "--unit cm --up z", {"--unit", "cm", "--up", "z"}},
                           {away, "--move", {"--move", "0", "-5", "0"}}}) {
        const std::string message = refusal(options_for(test.mesh));
        EXPECT_NE(message.find("it is not where the character is"), std::string::npos) << message;
        EXPECT_NE(message.find(test.remedy), std::string::npos) << message;
        const ImportResult result = import_file(options_for("thing.obj", test.mends));
        EXPECT_LT((load_garment_mesh(result.files[0]).vertices - shirt.vertices).norm(), 0.01);
        std::filesystem::remove_all(path("out"));
    }
}

TEST_F(ImportFile, TheMoveThatIsProposedBringsTheGarmentAbout) {
    // MakeHuman's files have the middle of the body on the origin.
    TriMesh shirt = worn_garment("tshirt_1000");
    shirt.vertices.col(1).array() -= 0.85;
    TriMesh pants = worn_garment("pants_1000");
    pants.vertices.col(1).array() -= 0.85;
    const std::string message = refusal(options_for(together(shirt, pants)));
    const size_t at = message.find("--move ");
    ASSERT_NE(at, std::string::npos) << message;
    double x = 1.0, y = 0.0, z = 1.0;
    ASSERT_EQ(std::sscanf(message.c_str() + at, "--move %lf %lf %lf", &x, &y, &z), 3);
    EXPECT_NEAR(y, 0.85, 0.1) << message;
    EXPECT_NE(message.find("with the middle at the origin"), std::string::npos) << message;
    EXPECT_EQ(message.find("lies on its side"), std::string::npos) << message;
}

TEST_F(ImportFile, AMoveThatIsProposedCanBeFollowed) {
    TriMesh beside = worn_garment("skirt_1000");
    beside.vertices.col(0).array() += 2.0;
    TriMesh above = worn_garment("tshirt_1000");
    above.vertices.col(1).array() += 5.0;
    for (const TriMesh& mesh : {beside, above}) {
        const std::string message = refusal(options_for(mesh));
        EXPECT_EQ(message.find("-0.00"), std::string::npos) << message;
        const size_t at = message.find("--move ");
        ASSERT_NE(at, std::string::npos) << message;
        std::istringstream words(message.substr(at));
        std::string option, x, y, z;
        words >> option >> x >> y >> z;
        const ImportResult result = import_file(options_for("thing.obj", {"--move", x, y, z}));
        EXPECT_LT(result.json.at("garments").at(0).at("part_inside_before"), 0.3) << message;
        std::filesystem::remove_all(path("out"));
    }
    const std::string message = refusal(options_for(beside));
    EXPECT_NE(message.find("--move -2.00 0.00 "), std::string::npos) << message;
}

TEST_F(ImportFile, WhatLiesBesideTheCharacterWithAnotherAxisUpIsSaid) {
    const TriMesh skirt = worn_garment("skirt_1000");
    TriMesh z_up = skirt, minus_z_up = skirt;
    z_up.vertices << skirt.vertices.col(0), -skirt.vertices.col(2), skirt.vertices.col(1);
    minus_z_up.vertices << skirt.vertices.col(0), skirt.vertices.col(2), -skirt.vertices.col(1);
    const std::string message = refusal(options_for(z_up));
    EXPECT_NE(message.find("it lies beside the character"), std::string::npos) << message;
    EXPECT_NE(message.find("--up z if the file has z up; --up y takes"), std::string::npos)
        << message;
    const ImportResult mended = import_file(options_for("thing.obj", {"--up", "z"}));
    EXPECT_EQ(mended.json.at("garments").at(0).at("sort"), "skirt");
    import_file(options_for("thing.obj", {"--up", "y", "--move", "0", "0", "-0.1"}));
    std::filesystem::remove_all(path("out"));
    EXPECT_NE(refusal(options_for(minus_z_up)).find("where -z points up now"), std::string::npos);
}

TEST_F(ImportFile, WideClothesAreNotTakenForTurnedOnes) {
    TriMesh gown = worn_garment("skirt_1000");
    const double waist = gown.vertices.col(1).maxCoeff(), low = gown.vertices.col(1).minCoeff();
    for (Eigen::Index i = 0; i < gown.vertices.rows(); ++i) {
        const double wider = 1.0 + 2.5 * (waist - gown.vertices(i, 1)) / (waist - low);
        gown.vertices(i, 0) *= wider;
        gown.vertices(i, 2) *= wider;
    }
    import_file(options_for(gown));
    TriMesh train = sheet_on_the_floor();
    std::filesystem::remove_all(path("out"));
    try {
        import_file(options_for(train));
    } catch (const std::exception& error) {
        EXPECT_EQ(std::string(error.what()).find("lies beside"), std::string::npos) << error.what();
    }
}

TEST_F(ImportFile, ADressedCharacterIsToldApartByItsMeshes) {
    const std::string file = model_path("Collada/human.zae");
    ImportOptions options = parse_import_options({file, "--character", file, "--out", path("out")});
    const std::string message = refusal(options);
    EXPECT_EQ(message.rfind(file + ": it is garment and character at once", 0), 0u) << message;
    EXPECT_NE(message.find("human-baseMesh"), std::string::npos) << message;
    EXPECT_NE(message.find("Remedy: --mesh NAME"), std::string::npos) << message;
    save_obj(path("thing.obj"), worn_garment("skirt_1000"));
    std::filesystem::create_symlink(path("thing.obj"), path("link.obj"));
    options = options_for("thing.obj", {"--character", path("link.obj")});
    EXPECT_NE(refusal(options).find("has one mesh only"), std::string::npos);
}

TEST_F(ImportFile, ColoursThatAreNotThereAreMissed) {
    save_obj(path("thing.obj"), worn_garment("skirt_1000"));
    const std::string message = refusal(options_for("thing.obj", {"--goal-colours", "0.1"}));
    EXPECT_NE(message.find("it has no vertex colours"), std::string::npos) << message;
    EXPECT_NE(message.find("leave --goal-colours out"), std::string::npos) << message;
}

TEST_F(ImportFile, CommandsThatItProposesAreQuotedForAShell) {
    save_obj(path("it's & co.obj"), worn_garment("tshirt_1000"));
    ImportOptions options = options_for("it's & co.obj");
    options.programs = "/opt/my programs/";
    const std::string text = import_file(options).text;
    EXPECT_NE(
        text.find("\n  '/opt/my programs/compare' --garment '" + path("out/it'\\''s & co.obj'")),
        std::string::npos)
        << text;
}

TEST_F(ImportFile, ASkirtThatLiesOnItsSideIsSaid) {
    TriMesh skirt = worn_garment("skirt_1000");
    skirt.vertices.col(0).swap(skirt.vertices.col(1));
    const std::string message = refusal(options_for(skirt));
    EXPECT_NE(message.find("if it lies on its side, turn it upright"), std::string::npos)
        << message;
    for (const char* name : {"skirt_1000", "tshirt_1000", "pants_1000", "tank_top_1000"})
        EXPECT_FALSE(lies_on_its_side(worn_garment(name))) << name;
}

TEST_F(ImportFile, BrokenFilesAreRefusedWithARemedy) {
    const TriMesh shirt = worn_garment("tshirt_1000");
    TriMesh strip = moebius(60);
    strip.vertices.col(1).array() += 1.1;
    write("empty.obj", "");
    write("points.obj", "v 0 1 0\nv 0 1 1\nv 0 2 0\n");
    write("nan.obj", "v 0 1 0\nv nan 1 1\nv 0 2 0\nf 1 2 3\n");
    write("line.obj", "v 0 0.2 0\nv 0 1 0\nv 0 1.5 0\nf 1 2 3\n");
    write("text.mhclo", "verts 0\n1 2\n");
    save_obj(path("strip.obj"), strip);
    for (const auto& [file, part] :
         std::vector<std::pair<std::string, std::string>>{{"none.obj", "no such file"},
                                                          {"empty.obj", "empty.obj"},
                                                          {"points.obj", "points.obj"},
                                                          {"nan.obj", "not finite"},
                                                          {"line.obj", "no face with an area"},
                                                          {"text.mhclo", "line 2"},
                                                          {"strip.obj", "one side only"}}) {
        const std::string message = refusal(options_for(file));
        EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
        EXPECT_NE(message.find("Remedy: "), std::string::npos) << message;
    }
}

TEST_F(ImportFile, ItsOwnInputIsNotOverwritten) {
    save_obj(path("thing.obj"), worn_garment("tshirt_1000"));
    EXPECT_THROW(parse_import_options({path("thing.obj"), "--out", path("")}), UsageError);
}

TEST_F(ImportFile, AWornShapeOfAnEarlierImportIsRemoved) {
    import_file(options_for(worn_garment("skirt_1000")));
    EXPECT_TRUE(std::filesystem::exists(path("out/thing.worn.obj")));
    import_file(options_for(worn_garment("tshirt_1000")));
    EXPECT_FALSE(std::filesystem::exists(path("out/thing.worn.obj")));
}

TEST_F(ImportFile, WhatWasModelledOnAnotherBodyIsCarriedToTheDefaultOne) {
    const auto shapes = BodyShapes::load_shared();
    if (!shapes) GTEST_SKIP() << "no shared data";
    const Body standard = Body::load_default();
    BodyShape heavy;  // as body_named() has it
    heavy.female = 0.0;
    heavy.weight = 0.75;
    heavy.waist = 0.3;
    const Outfit worn =
        fit_outfit(load_outfit("tshirt_1000"), standard, standard.with_rest(shapes->skin(heavy)));
    save_obj(path("thing.obj"), {worn.start.x, worn.garment.rest().faces});
    const ImportResult result = import_file(options_for("thing.obj", {"--body", "heavy"}));
    const Points back = load_garment_mesh(result.files[0]).vertices;
    EXPECT_LT((back - worn_garment("tshirt_1000").vertices).rowwise().norm().mean(), 0.015);
}

TEST_F(ImportFile, ACharacterWearsWhatWasImportedForIt) {
    const std::string person = model_path("X/BCN_Epileptic.X");
    save_obj(path("skirt.obj"), worn_garment("skirt_1000"));
    const ImportResult result = import_file(
        options_for("skirt.obj", {"--character", person, "--move", "-0.02", "-1.02", "-0.17"}));
    EXPECT_EQ(result.json.at("character"), person);
    EXPECT_NE(result.text.find("bake --character " + person), std::string::npos);
    EXPECT_NE(result.text.find("--clearance 0.003"), std::string::npos) << result.text;
    CharacterSceneSettings settings;
    settings.character = person;
    settings.garment = result.files[0];
    settings.clearance = 0.003;
    settings.steps = 2;
    const CharacterScene scene(settings);
    const Points rest = scene.garment().rest().vertices;
    EXPECT_GT((scene.start().x - rest).norm(), 0.01) << "worn is longer than the band at rest";
    EXPECT_GE(smallest_clearance(
                  {scene.start().x, scene.garment().rest().faces},
                  SurfaceDistance({scene.skin(0.0), *scene.boundary(0, 0.01).obstacles[0].faces})),
              0.0029);
}

TEST_F(ImportFile, AFileOfMakeHumanNeedsItsBody) {
    write("patch.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
    write("patch.mhclo", "obj_file patch.obj\nverts 0\n1\n2\n3\n");
    const ImportOptions options =
        options_for("patch.mhclo", {"--character", model_path("X/BCN_Epileptic.X")});
    EXPECT_NE(refusal(options).find("it fits MakeHuman's body"), std::string::npos);
}

}  // namespace cloth::import_file_test
