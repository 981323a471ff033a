#include "data/files/mhclo.h"

#include <filesystem>

#include "data/body/body_shapes.h"
#include "data/core/paths.h"
#include "data/core/surface_distance.h"
#include "data/files/mesh_io.h"
#include "tests/data/files/file_fixture.h"

namespace cloth::mhclo_test {

using namespace cloth::test;

namespace {

const char* const obj_text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 4 3 2 1\n";
const char* const head =
    "# clothes\nbasemesh hm08\nname patch\nobj_file patch.obj\n"
    "x_scale 0 1 2.0\ny_scale 0 2 1.0\nz_depth 50\nmaterial patch.mhmat\nverts 0\n";
const char* const rows = "0 1 2 0.5 0.25 .25 0.1 0.2 0.3\n1\n2\n0 1 2 1 0 0 0 0 -1\n";
const char* const tail = "\ndelete_verts\n5 - 9 12\n";

class Mhclo : public FileTest {
 protected:
    void SetUp() override {
        FileTest::SetUp();
        write("patch.obj", obj_text);
    }
    std::string file(const std::string& text) const { return write("patch.mhclo", text); }
    std::string whole() const { return file(std::string(head) + rows + tail); }

    static Points base() {
        Points points(3, 3);
        points << 0, 0, 0, 4, 0, 0, 0, 3, 0;
        return points;
    }
};

}  // namespace

TEST_F(Mhclo, RowsAreWeightedPlacesWithScaledOffsets) {
    const MhcloFile clothes = load_mhclo(whole());
    EXPECT_EQ(clothes.name, "patch");
    ASSERT_EQ(clothes.rows.size(), 4u);
    EXPECT_EQ(clothes.highest_vertex(), 2);
    const Points places = clothes.places(base());
    // The base is twice as wide (4 / 2) and three times as high (3 / 1) as the clothes were made
    // for.
    EXPECT_TRUE(places.row(0).isApprox(Eigen::RowVector3d(1 + 0.2, 0.75 + 0.6, 0.3)));
    EXPECT_EQ(places.row(1), base().row(1));
    EXPECT_EQ(places.row(3), Eigen::RowVector3d(0, 0, -1));
}

TEST_F(Mhclo, TheMeshHasTheFacesOfTheObjFile) {
    const TriMesh mesh = load_mhclo_mesh(load_mhclo(whole()), base());
    const TriMesh flat = load_mesh(path("patch.obj"));
    EXPECT_EQ(mesh.faces, flat.faces);
    EXPECT_EQ(mesh.vertices.row(1), base().row(1));
    EXPECT_EQ(mesh.vertices.row(2), base().row(2));
}

TEST_F(Mhclo, DamagedFilesAreNamedWithLineAndRemedy) {
    const std::string start = head;
    for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{
             {start + "0 1 2 0.5 0.25\n", "line 10"},
             {start + "0 1 2 0.5 0.25 nan 0 0 0\n", "line 10"},
             {start + "0 1 -2 0.5 0.25 .25 0 0 0\n", "line 10"},
             {start + "0 1 2.5 0.5 0.25 .25 0 0 0\n", "line 10"},
             {start + "99999999999\n", "line 10"},
             {"x_scale 0 1 0\n" + start + rows, "line 1"},
             {"x_scale 0 1\n" + start + rows, "line 1"},
             {"obj_file ../other.obj\n" + start + rows, "line 1"},
             {start, "no rows"},
             {"name patch\nverts 0\n1\n", "no OBJ file"}})
        expect_load_error([&, written = file(text)] { load_mhclo(written); }, "patch.mhclo", part);
    expect_load_error([&] { load_mhclo(path("none.mhclo")); }, "none.mhclo", "cannot be opened");
}

TEST_F(Mhclo, FilesThatDoNotBelongTogetherAreRefused) {
    const MhcloFile fewer = load_mhclo(file(std::string(head) + "0\n1\n"));
    expect_load_error([&] { load_mhclo_mesh(fewer, base()); }, "patch.obj", "4 vertices");
    const MhcloFile higher = load_mhclo(file(std::string(head) + rows + "7\n"));
    EXPECT_THROW(higher.places(base()), ArgumentError);
    const MhcloFile huge =
        load_mhclo(file(std::string(head) + "0 1 2 1e308 1e308 1e308 1e308 1e308 1e308\n"));
    EXPECT_THROW(huge.places(1e10 * base()), ArgumentError);
}

TEST(MhcloOfMakeHuman, ItsClothesComeToLieOnEveryBody) {
    const auto folder = shared_data_path("body_makehuman/clothes");
    const auto shapes = BodyShapes::load_shared();
    if (!folder || !shapes) GTEST_SKIP() << "no MakeHuman data in the shared data folder";
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
        if (entry.path().extension() != ".mhclo") continue;
        ++files;
        const MhcloFile clothes = load_mhclo(entry.path().string());
        BodyShape heavy;
        heavy.weight = 0.9;
        for (const BodyShape& shape : {BodyShape(), heavy}) {
            const TriMesh worn = load_mhclo_mesh(clothes, shapes->base_mesh(shape));
            const TriMesh skin{shapes->skin(shape),
                               load_mesh(model_path("Collada/human.zae"), "human-baseMesh").faces};
            const SurfaceDistance distance(skin);
            double farthest = 0.0;
            for (Eigen::Index i = 0; i < worn.vertices.rows(); ++i)
                farthest =
                    std::max(farthest, std::abs(distance.nearest(worn.vertices.row(i)).distance));
            EXPECT_LT(farthest, 0.12) << entry.path();  // the skirt, between the legs
        }
    }
    EXPECT_GE(files, 1);
}

}  // namespace cloth::mhclo_test
