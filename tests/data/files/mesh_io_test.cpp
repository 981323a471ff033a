#include "data/files/mesh_io.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "data/core/errors.h"

namespace cloth::mesh_io_test {

namespace {

const std::string kModels = "/usr/share/assimp/models/";  // Debian's assimp-testmodels
const std::string kHuman = kModels + "Collada/human.zae";

/// A folder of its own for each test, gone afterwards.
class MeshIo : public testing::Test {
 protected:
    void SetUp() override {
        m_folder = std::filesystem::temp_directory_path() /
                   (std::string("mesh_io_") +
                    testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(m_folder);
    }
    void TearDown() override { std::filesystem::remove_all(m_folder); }

    std::string path(const std::string& name) const { return (m_folder / name).string(); }

    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(path(name), std::ios::binary) << text;
        return path(name);
    }

    std::filesystem::path m_folder;
};

std::string read(const std::string& path) {
    std::stringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

/// What load_mesh() says about a broken file.
std::string error_of(const std::string& path, const std::string& mesh = "") {
    try {
        load_mesh(path, mesh);
    } catch (const LoadError& error) {
        return error.what();
    }
    return "no error";
}

void expect_error(const std::string& path, const std::string& part, const std::string& mesh = "") {
    const std::string error = error_of(path, mesh);
    EXPECT_NE(error.find(path), std::string::npos) << error;
    EXPECT_NE(error.find(part), std::string::npos) << error;
    EXPECT_NE(error.find("Remedy: "), std::string::npos) << error;
}

const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

std::string ply(const std::string& vertices, const std::string& faces, int vertex_count,
                int face_count) {
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertex_count) +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
           std::to_string(face_count) + "\nproperty list uchar int vertex_indices\nend_header\n" +
           vertices + faces;
}

}  // namespace

TEST_F(MeshIo, ObjKeepsTheOrderOfTheFileAndDoublePrecision) {
    const std::string file = write("quad.obj",
                                   "v 0.12345678901234567 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                   "f 4 1 2 3\n");
    const TriMesh mesh = load_mesh(file);
    ASSERT_EQ(mesh.vertices.rows(), 4);
    EXPECT_EQ(mesh.faces.rows(), 2);
    EXPECT_EQ(mesh.vertices(0, 0), 0.12345678901234567);
    EXPECT_EQ(Vec3(mesh.vertices.row(3)), Vec3(0, 1, 0));
    EXPECT_GT(face_area_vectors(mesh.vertices, mesh.faces)(0, 2), 0.0);
}

TEST_F(MeshIo, SavedObjIsReadBackBitByBit) {
    TriMesh mesh;
    mesh.vertices.resize(4, 3);
    mesh.vertices << 0.1, 1e-9, -3.0 / 7.0, 1, 0, -0.0, std::sqrt(2.0), 1.0 / 3.0, 1e5, 0, 1, 1;
    mesh.faces.resize(2, 3);
    mesh.faces << 2, 1, 0, 0, 3, 2;
    save_obj(path("a.obj"), mesh);
    const TriMesh back = load_mesh(path("a.obj"));
    EXPECT_EQ(back.vertices, mesh.vertices);
    EXPECT_EQ(back.faces, mesh.faces);
    EXPECT_FALSE(std::filesystem::exists(path("a.obj.tmp")));
}

TEST_F(MeshIo, ExactDuplicatesAreWeldedAndLooseVerticesLeftOut) {
    const TriMesh mesh = load_mesh(
        write("two.obj",
              "v 0 0 0\nv 9 9 9\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 3 4\nf 5 6 7\n"));
    ASSERT_EQ(mesh.vertices.rows(), 4);
    EXPECT_EQ(Vec3(mesh.vertices.row(3)), Vec3(1, 1, 0));
    EXPECT_EQ(undirected_edges(mesh.faces).size(), 5u);
}

TEST_F(MeshIo, NearbyVerticesAreNotWelded) {
    const TriMesh mesh = load_mesh(
        write("near.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1.00001 0 0\nv 1 1 0\nf 1 2 3\nf 4 5 3\n"));
    EXPECT_EQ(mesh.vertices.rows(), 5);
}

TEST_F(MeshIo, PlyKeepsTheOrderOfTheFile) {
    const TriMesh mesh =
        load_mesh(write("a.ply", ply("0 0 0\n1 0 0\n1 1 0\n0 1 0\n", "3 3 1 2\n3 0 1 3\n", 4, 2)));
    ASSERT_EQ(mesh.vertices.rows(), 4);
    EXPECT_EQ(Vec3(mesh.vertices.row(2)), Vec3(1, 1, 0));
    EXPECT_EQ(mesh.faces.row(0), Eigen::RowVector3i(3, 1, 2));
}

TEST_F(MeshIo, HumanHasTheVerticesOfTheFileInItsOrder) {
    if (!std::filesystem::exists(kHuman)) GTEST_SKIP() << kHuman << ": install assimp-testmodels";
    const TriMesh skin = load_mesh(kHuman, "human-baseMesh");
    ASSERT_EQ(skin.vertices.rows(), 13380);
    EXPECT_EQ(skin.faces.rows(), 26756);
    // The first, second and third position of the file's list; the faces begin with number 4848.
    EXPECT_EQ(Vec3(skin.vertices.row(0)), Vec3(-0.0330, 1.5565, 0.1345));
    EXPECT_EQ(Vec3(skin.vertices.row(1)), Vec3(-0.0293, 1.5566, 0.1351));
    EXPECT_EQ(Vec3(skin.vertices.row(2)), Vec3(-0.0328, 1.5580, 0.1353));
    EXPECT_EQ(skin.faces(0, 0), 4848);
    const Vec3 extent = skin.vertices.colwise().maxCoeff() - skin.vertices.colwise().minCoeff();
    EXPECT_NEAR(extent.y(), 1.659, 1e-3);
    EXPECT_EQ(undirected_edges(skin.faces).size(), 13380u + 26756u - 2u) << "closed, genus 0";
}

TEST_F(MeshIo, HumanMatchesTheBaseMeshOfMakeHumanFaceByFace) {
    const std::string base = std::string(CLOTH_SHARED_DIR) + "/data/body_makehuman/base.obj";
    if (!std::filesystem::exists(base) || !std::filesystem::exists(kHuman))
        GTEST_SKIP() << base << " is not there";
    const TriMesh skin = load_mesh(kHuman, "human-baseMesh");
    const TriMesh oracle = load_mesh(base, "body");
    ASSERT_EQ(oracle.vertices.rows(), skin.vertices.rows());
    // The diagonals of the quads depend on the shape, so edges are compared by their number.
    EXPECT_EQ(oracle.faces.rows(), skin.faces.rows());
    int equal = 0;
    for (Eigen::Index f = 0; f < skin.faces.rows(); ++f)
        equal += skin.faces.row(f) == oracle.faces.row(f);
    EXPECT_GT(equal, 26756 * 0.95);
}

TEST_F(MeshIo, WithoutANameAllMeshesAreRead) {
    if (!std::filesystem::exists(kHuman)) GTEST_SKIP() << kHuman << ": install assimp-testmodels";
    EXPECT_EQ(load_mesh(kHuman).vertices.rows(), 13380 + 1064);
    EXPECT_EQ(load_mesh(kHuman, "human-highpolyeyesMesh").vertices.rows(), 1064);
    expect_error(kHuman, "human-baseMesh, human-highpolyeyesMesh", "eyes");
}

TEST_F(MeshIo, UnitsAndAxisOfColladaAreApplied) {
    const std::string duck = kModels + "Collada/duck.dae";  // centimetres, one geometry, Y up
    if (!std::filesystem::exists(duck)) GTEST_SKIP() << duck << ": install assimp-testmodels";
    const TriMesh mesh = load_mesh(duck);
    const Vec3 extent = mesh.vertices.colwise().maxCoeff() - mesh.vertices.colwise().minCoeff();
    EXPECT_LT(extent.maxCoeff(), 3.0);
    EXPECT_GT(extent.maxCoeff(), 0.3);
}

TEST_F(MeshIo, GltfBoxHasEightCorners) {
    const std::string box = kModels + "glTF2/BoxTextured-glTF/BoxTextured.gltf";
    if (!std::filesystem::exists(box)) GTEST_SKIP() << box << ": install assimp-testmodels";
    const TriMesh mesh = load_mesh(box);
    EXPECT_EQ(mesh.vertices.rows(), 8);
    EXPECT_EQ(mesh.faces.rows(), 12);
}

TEST_F(MeshIo, MissingFileIsNamed) {
    expect_error(path("no.obj"), "there is no such file");
}

TEST_F(MeshIo, AFolderIsNoFile) {
    expect_error(path(""), "is a folder");
}

TEST_F(MeshIo, AByteOrderMarkCostsNoVertex) {
    // The first vertex is that of a line which assimp would not know.
    const std::string text = "v 0.1 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 2 4 3\nf 1 2 3\n";
    const TriMesh marked = load_mesh(write("marked.obj", "\xEF\xBB\xBF" + text));
    const TriMesh plain = load_mesh(write("plain.obj", text));
    ASSERT_EQ(marked.vertices.rows(), 4);
    EXPECT_EQ(marked.vertices, plain.vertices) << "to the last bit, which assimp does not hand on";
    EXPECT_EQ(marked.faces, plain.faces);
    expect_error(write("nan.obj", "\xEF\xBB\xBFv nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
                 "nan.obj, line 1: ");
}

TEST_F(MeshIo, EmptyFileIsRefused) {
    for (const char* name : {"e.obj", "e.ply", "e.dae", "e.zae", "e.gltf"})
        expect_error(write(name, ""), "empty");
}

TEST_F(MeshIo, FileWithoutFacesIsRefused) {
    expect_error(write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "");
    expect_error(write("comment.obj", "# nothing here\n"), "");
}

TEST_F(MeshIo, UnknownFormatIsRefused) {
    expect_error(write("notes.txt", "hello"), "cannot be read");
}

TEST_F(MeshIo, VertexThatIsNotFiniteIsNamed) {
    expect_error(write("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), "not finite");
    expect_error(write("inf.obj", "v 0 0 0\nv inf 0 0\nv 0 1 0\nf 1 2 3\n"), "not finite");
    expect_error(write("nan.ply", ply("0 0 0\nnan 0 0\n0 1 0\n", "3 0 1 2\n", 3, 1)),
                 "vertex 1: its position is not finite");
}

/// assimp numbers the corners of faces; who mends the file needs its lines.
TEST_F(MeshIo, ObjPositionThatIsNotFiniteIsNamedByItsLine) {
    std::string text = "# a grid\n\nmtllib none.mtl\no grid\n";
    for (int k = 0; k < 700; ++k) {
        const std::string x = k == 650 ? "nan" : std::to_string(k / 70);
        text += "v " + x + " " + std::to_string(k % 70) + " 0\n";
    }
    text += "vt nan 0\nvn 0 0 nan\n";  // not read
    for (int i = 0; i < 9; ++i)
        for (int k = 1; k < 70; ++k) {
            const int a = 70 * i + k, b = a + 70;
            text += "f " + std::to_string(b + 1) + " " + std::to_string(b) + " " +
                    std::to_string(a) + " " + std::to_string(a + 1) + "\n";
        }
    expect_error(write("grid.obj", text), "grid.obj, line 655: its position is not finite");
}

TEST_F(MeshIo, ThePositionOfAFaceIsNamedNotALooseOne) {
    expect_error(
        write("loose.obj", "v inf 7 7\nv 0 0 0\r\nv 1 nan 0 0.5 0.5 0.5\r\nv 0 1 0\nf 2 3 4\n"),
        ", line 3: ");
    EXPECT_EQ(load_mesh(write("kept.obj", "v inf 7 7\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 4\n"))
                  .vertices.rows(),
              3);
    expect_error(write("large.obj", "v 0 0 0\nv 1 0 0\nv 0 1e60 0\nf 1 2 3\n"), ", line 3: ");
}

TEST_F(MeshIo, ColladaPositionThatIsNotFiniteIsNamedByItsLine) {
    const auto collada = [](const char* numbers) {
        return std::string(
                   "<?xml version=\"1.0\"?>\n<COLLADA "
                   "xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
                   "version=\"1.4.1\">\n<library_geometries>"
                   "<geometry id=\"sheet\" name=\"sheet\"><mesh>\n"
                   "<source id=\"p\"><float_array id=\"a\" count=\"12\">\n") +
               numbers +
               "</float_array><technique_common><accessor source=\"#a\" count=\"4\" stride=\"3\">"
               "<param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/>"
               "<param name=\"Z\" type=\"float\"/></accessor></technique_common></source>\n"
               "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\n"
               "<triangles count=\"2\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
               "<p>0 1 2 2 1 3</p></triangles></mesh></geometry></library_geometries>\n"
               "<library_visual_scenes><visual_scene id=\"s\"><node id=\"n\">"
               "<instance_geometry url=\"#sheet\"/></node></visual_scene>"
               "</library_visual_scenes>\n<scene><instance_visual_scene url=\"#s\"/></scene>"
               "</COLLADA>\n";
    };
    EXPECT_EQ(load_mesh(write("good.dae", collada("0 0 0\n1 0 0\n0 1 0\n1 1 0"))).faces.rows(), 2);
    expect_error(write("nan.dae", collada("0 0 0\n1 0 0\n0 1 0\n1 nan 0")),
                 "nan.dae, line 8, position 3 of geometry sheet: ");
}

TEST_F(MeshIo, FaceWithoutAreaIsNamed) {
    expect_error(write("zero.obj", std::string(kTriangle) + "v 2 0 0\nf 1 2 4\n"),
                 "triangle 1: it has no area");
    expect_error(write("twice.obj", std::string(kTriangle) + "f 1 2 2\n"), "no area");
}

TEST_F(MeshIo, IndexOutOfRangeIsRefused) {
    expect_error(write("high.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"), "");
    expect_error(write("zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"), "");
    expect_error(write("high.ply", ply("0 0 0\n1 0 0\n0 1 0\n", "3 0 1 7\n", 3, 1)), "");
}

TEST_F(MeshIo, TruncatedFilesAreRefused) {
    expect_error(write("cut.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2"), "damaged");
    expect_error(write("cut.ply", ply("0 0 0\n1 0 0\n0 1 0\n", "", 3, 1)), "");
    expect_error(write("cut2.ply", ply("0 0 0\n1 0 0\n", "", 3, 1)), "");
    expect_error(write("cut3.ply", ply("0 0 0\n1 0 0\n1 1 0\n0 1 0\n", "3 0 1 2\n", 4, 2)),
                 "face 1: the file ends too early");
    expect_error(write("cut4.ply", ply("0 0 0\n1 0 0\n1 1 0\n", "3 0 1", 3, 1)),
                 "face 0: the file ends too early");
    expect_error(write("cut5.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"), "end_header");
    if (!std::filesystem::exists(kHuman)) return;
    expect_error(write("cut.zae", read(kHuman).substr(0, 500000)), "");
    const std::string duck = read(kModels + "Collada/duck.dae");
    expect_error(write("cut.dae", duck.substr(0, duck.size() / 2)), "");
}

TEST_F(MeshIo, TruncatedBinaryPlyIsRefusedWholeIsRead) {
    const std::string cube = kModels + "PLY/cube_binary.ply";
    if (!std::filesystem::exists(cube)) GTEST_SKIP() << cube << ": install assimp-testmodels";
    EXPECT_EQ(load_mesh(cube).vertices.rows(), 8);
    EXPECT_EQ(load_mesh(cube).faces.rows(), 12);
    const std::string whole = read(cube);
    expect_error(write("cut.ply", whole.substr(0, whole.size() - 1)), "face 11: the file ends");
}

TEST_F(MeshIo, PlyElementWithoutPropertiesIsRefusedAtOnce) {
    std::string text = ply("0 0 0\n1 0 0\n0 1 0\n", "3 0 1 2\n", 3, 1);
    text.insert(text.find("end_header"), "element nothing 4000000000000\n");
    expect_error(write("endless.ply", text), "element nothing");
}

TEST_F(MeshIo, WhatAssimpCrashesOnIsRefusedBefore) {
    expect_error(write("deep.gltf", std::string(600, '[')), "nested");
    std::string tags;
    for (int k = 0; k < 600; ++k) tags += "<a>";
    expect_error(write("deep.dae", tags), "nested");
    expect_error(write("skin.gltf", R"({"asset":{"version":"2.0"},"skins":[{"joints":[0]}]})"),
                 "inverseBindMatrices");
    expect_error(write("long.gltf", R"({"accessors":[{"count":4000000000,"type":"VEC3"}]})"),
                 "larger than the file");
    expect_error(write("count.dae", "<COLLADA><float_array count=\"inf\"/></COLLADA>"),
                 "the count");
    expect_error(write("offset.dae", "<COLLADA><input offset=\"99999\"/></COLLADA>"), "the offset");
    expect_error(write("corners.dae", "<COLLADA><vcount>3 100000000</vcount></COLLADA>"),
                 "corners");
    expect_error(write("no.zae", "PK\3\4 and then nothing"), "zip");
}

TEST_F(MeshIo, NumberThatOnlyCKnowsIsNoCrash) {
    expect_error(write("hex.obj", "v 0 0 0\nv .0x1p+3 0 0\nv 0 - 0\nf 1 2 3\n"), "");
    const TriMesh mesh = load_mesh(write("dot.obj", "v 0 0 0\nv 1. 0 0\nv 0 1 0\nf 1 2 3\n"));
    EXPECT_EQ(mesh.vertices(1, 0), 1.0);
}

TEST_F(MeshIo, WritingIntoAMissingFolderFails) {
    TriMesh mesh;
    EXPECT_THROW(save_obj(path("no/such/folder.obj"), mesh), LoadError);
}

}  // namespace cloth::mesh_io_test
