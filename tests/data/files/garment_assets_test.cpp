#include "data/files/garment_assets.h"

#include "data/files/mesh_io.h"
#include "tests/data/files/file_fixture.h"

namespace cloth::garment_assets_test {

using namespace cloth::test;

namespace {

class GarmentAssets : public FileTest {
 protected:
    void SetUp() override {
        FileTest::SetUp();
        m_mesh.vertices.resize(4, 3);
        m_mesh.vertices << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
        m_mesh.faces.resize(2, 3);
        m_mesh.faces << 0, 1, 2, 0, 2, 3;
        save_obj(path("own.obj"), m_mesh);
    }
    TriMesh m_mesh;
};

TEST_F(GarmentAssets, AGarmentOfOnesOwnIsTakenByItsPath) {
    const Garment own = load_garment(path("own.obj"));
    EXPECT_EQ(own.name(), "own");
    EXPECT_EQ(own.rest().vertices, m_mesh.vertices);
    EXPECT_EQ(load_garment_start(path("own.obj")).x, m_mesh.vertices);
}

TEST_F(GarmentAssets, TheWornShapeLiesBesideIt) {
    TriMesh worn = m_mesh;
    worn.vertices *= 1.5;
    save_obj(path("own.worn.obj"), worn);
    EXPECT_EQ(load_garment_start(path("own.obj")).x, worn.vertices);
    EXPECT_EQ(load_garment(path("own.obj")).rest().vertices, m_mesh.vertices);
}

TEST_F(GarmentAssets, AWornShapeOfOtherFacesIsRefused) {
    TriMesh worn = m_mesh;
    worn.faces.conservativeResize(1, 3);
    worn.vertices.conservativeResize(3, 3);
    save_obj(path("own.worn.obj"), worn);
    expect_load_error([&] { load_garment_start(path("own.obj")); }, "own.worn.obj", "its faces");
    worn = m_mesh;
    worn.faces << 0, 1, 3, 1, 2, 3;
    save_obj(path("own.worn.obj"), worn);
    expect_load_error([&] { load_garment_start(path("own.obj")); }, "own.worn.obj", "its faces");
}

TEST_F(GarmentAssets, WrongNamesAndPathsAreNamed) {
    expect_load_error([] { load_garment("toga"); }, "toga", "pants_1000");
    expect_load_error([&] { load_garment(path("toga.obj")); }, "toga.obj", "no such file");
}

}  // namespace

}  // namespace cloth::garment_assets_test
