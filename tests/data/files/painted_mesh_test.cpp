// What is painted on the vertices of a file: limits of skinned goals.
#include "data/files/painted_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "data/core/garment.h"
#include "tests/data/files/file_fixture.h"
#include "tests/ranges.h"

namespace cloth::painted_mesh_test {
namespace {

using namespace cloth::test;

constexpr double infinity = std::numeric_limits<double>::infinity();

class PaintedMeshFile : public FileTest {};

std::string to_base64(const std::string& bytes) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (size_t k = 0; k < 3; ++k)
            bits =
                bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0);
        for (size_t k = 0; k < 4; ++k)
            text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
    return text;
}

template <typename Number>
void append(std::string& bytes, const std::vector<Number>& numbers) {
    const size_t from = bytes.size();
    bytes.resize(from + numbers.size() * sizeof(Number));
    std::memcpy(&bytes[from], numbers.data(), numbers.size() * sizeof(Number));
    bytes.resize((bytes.size() + 3) / 4 * 4);
}

/// A glTF of one primitive: a square of two triangles that share no vertices, so that two of its
/// places are split; what is painted is added by paint().
class Square {
 public:
    Square() {
        add(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 5126, "VEC3",
            "POSITION", 6);
    }
    template <typename Number>
    Square& paint(const std::string& name, const std::vector<Number>& numbers, int type = 5126,
                  const std::string& more = "", const std::string& shape = "SCALAR") {
        add(numbers, type, shape, name,
            numbers.size() / (shape == "SCALAR" ? 1
                              : shape == "VEC3" ? 3
                                                : 4),
            more);
        return *this;
    }
    std::string gltf() const {
        return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
               R"("meshes":[{"name":"cape","primitives":[{"attributes":{)" +
               m_attributes + R"(}}]}],"accessors":[)" + m_accessors + R"(],"bufferViews":[)" +
               m_views + R"(],"buffers":[{"byteLength":)" + std::to_string(m_bytes.size()) +
               R"(,"uri":"data:application/octet-stream;base64,)" + to_base64(m_bytes) + R"("}]})";
    }

 private:
    template <typename Number>
    void add(const std::vector<Number>& numbers, int type, const std::string& shape,
             const std::string& name, size_t count, const std::string& more = "") {
        const std::string comma = m_count == 0 ? "" : ",";
        const size_t begin = m_bytes.size();
        append(m_bytes, numbers);
        m_attributes += comma + "\"" + name + "\":" + std::to_string(m_count);
        m_accessors += comma + R"({"bufferView":)" + std::to_string(m_count) +
                       R"(,"componentType":)" + std::to_string(type) + R"(,"count":)" +
                       std::to_string(count) + R"(,"type":")" + shape + "\"" + more +
                       (name == "POSITION" ? R"(,"min":[0,0,0],"max":[1,1,0])" : "") + "}";
        m_views += comma + R"({"buffer":0,"byteOffset":)" + std::to_string(begin) +
                   R"(,"byteLength":)" + std::to_string(m_bytes.size() - begin) + "}";
        ++m_count;
    }

    std::string m_bytes, m_attributes, m_accessors, m_views;
    int m_count = 0;
};

VectorX vector_of(std::initializer_list<double> values) {
    VectorX result(static_cast<Eigen::Index>(values.size()));
    Eigen::Index i = 0;
    for (const double value : values) result[i++] = value;
    return result;
}

void expect_values(const VectorX& values, std::initializer_list<double> expected) {
    ASSERT_EQ(values.size(), static_cast<Eigen::Index>(expected.size()));
    for (Eigen::Index i = 0; i < values.size(); ++i) {
        const double e = *(expected.begin() + i);
        if (std::isinf(e)) {
            EXPECT_EQ(values[i], e) << i;
        } else {
            EXPECT_NEAR(values[i], e, 1e-6) << i;
        }
    }
}

/// What a file of the square's triangles is as a PLY, with a property per column.
std::string ply(const std::string& properties, const std::string& rows) {
    return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
           "property float z\n" +
           properties + "element face 2\nproperty list uchar int vertex_indices\nend_header\n" +
           rows + "3 0 1 2\n3 1 3 2\n";
}

TEST_F(PaintedMeshFile, AttributesOfGltfAreLimitsOfTheVerticesThatTheyAreOn) {
    Square square;
    square.paint<float>("_MAX_DISTANCE", {0, 0.1f, 0.2f, 0.1f, INFINITY, 0.2f});
    square.paint<float>("_backstop", {0.01f, 0.02f, 0.03f, 0.02f, 0.04f, 0.03f});
    square.paint<float>("_DRIVE_STIFFNESS", {5, 6, 7, 6, 8, 7});
    square.paint<float>("_DRIVE_DAMPING", {1, 2, 3, 2, 4, 3});
    square.paint<float>("_SOMETHING_ELSE", {-1, -2, -3, -4, -5, -6});
    const std::string file = write("cape.gltf", square.gltf());
    const PaintedMesh cape = load_painted_mesh(file);
    const TriMesh plain = load_mesh(file);
    EXPECT_EQ(cape.mesh.vertices, plain.vertices) << "the mesh is the same";
    EXPECT_EQ(cape.mesh.faces, plain.faces);
    ASSERT_EQ(plain.vertices.rows(), 4);
    expect_values(cape.limits.max_distance, {0, 0.1, 0.2, infinity});
    expect_values(cape.limits.backstop, {0.01, 0.02, 0.03, 0.04});
    expect_values(cape.limits.drive_stiffness, {5, 6, 7, 8});
    expect_values(cape.limits.drive_damping, {1, 2, 3, 4});
    EXPECT_TRUE(
        Garment("cape", cape.mesh, Fabric::soft_cotton()).with_goals(cape.limits).has_goals());
}

TEST_F(PaintedMeshFile, WhereASeamHasSeveralValuesTheTightestCounts) {
    Square square;
    square.paint<float>("_MAX_DISTANCE", {0.5f, 0.3f, 0.2f, 0.1f, 0.5f, 0.4f});
    square.paint<float>("_DRIVE_STIFFNESS", {5, 6, 7, 9, 8, 3});
    const PaintedMesh cape = load_painted_mesh(write("cape.gltf", square.gltf()));
    expect_values(cape.limits.max_distance, {0.5, 0.1, 0.2, 0.5});
    expect_values(cape.limits.drive_stiffness, {5, 9, 7, 8});
    EXPECT_EQ(cape.limits.backstop.size(), 0) << "nobody painted it";
}

TEST_F(PaintedMeshFile, NormalisedIntegersAreZeroToOne) {
    Square square;
    square.paint<std::uint8_t>("_MAX_DISTANCE", {0, 51, 255, 51, 102, 255}, 5121,
                               R"(,"normalized":true)");
    square.paint<std::uint16_t>("_BACKSTOP", {0, 13107, 65535, 13107, 26214, 65535}, 5123,
                                R"(,"normalized":true)");
    const PaintedMesh cape = load_painted_mesh(write("cape.gltf", square.gltf()));
    expect_values(cape.limits.max_distance, {0, 0.2, 1, 0.4});
    expect_values(cape.limits.backstop, {0, 0.2, 1, 0.4});
}

TEST_F(PaintedMeshFile, AFileWithoutPaintHasNoLimits) {
    const PaintedMesh cape = load_painted_mesh(write("cape.gltf", Square().gltf()));
    EXPECT_TRUE(cape.limits.empty());
    EXPECT_EQ(cape.limits.max_distance.size(), 0);
    EXPECT_FALSE(cape.unread_colours);
}

TEST_F(PaintedMeshFile, AttributesThatCannotBeUsedAreRefused) {
    const auto refuses = [&](const Square& square, const std::string& part) {
        const std::string file = write("cape.gltf", square.gltf());
        expect_load_error([&] { load_painted_mesh(file); }, file, part);
        EXPECT_NO_THROW(load_mesh(file)) << "who wants no limits need not mend them";
    };
    const std::string name = "_MAX_DISTANCE";
    const std::vector<float> good{0, 1, 2, 1, 3, 2};
    refuses(Square().paint<float>(name, {0, 1, 2}),
            "mesh cape, _MAX_DISTANCE: it has 3 values for 6");
    refuses(Square().paint<float>(name, {0, 1, NAN, 1, 3, 2}),
            "_MAX_DISTANCE, vertex 2: it is not a number");
    refuses(Square().paint<float>(name, {0, 1, 2, 1, -0.5f, 2}), "vertex 4: -0.5");
    refuses(Square().paint<float>("_DRIVE_STIFFNESS", {0, 1, 2, 1, INFINITY, 2}),
            "0 to 1e6 (1/s^2)");
    refuses(Square().paint<float>("_DRIVE_DAMPING", {0, 1, 2, 1, 2e4f, 2}), "0 to 1e4 (1/s)");
    refuses(Square().paint<std::uint8_t>(name, {0, 1, 2, 1, 3, 2}, 5121), "normalised");
    refuses(Square().paint<float>(name, std::vector<float>(18, 0.1f), 5126, "", "VEC3"), "SCALAR");
}

TEST_F(PaintedMeshFile, SparseAttributesAreRefused) {
    Square square;
    square.paint<float>("_MAX_DISTANCE", {0, 1, 2, 1, 3, 2}, 5126,
                        R"(,"sparse":{"count":1,"indices":{"bufferView":0,"componentType":5121},)"
                        R"("values":{"bufferView":1}})");
    const std::string file = write("cape.gltf", square.gltf());
    expect_load_error([&] { load_painted_mesh(file); }, file, "sparsely");
}

TEST_F(PaintedMeshFile, PropertiesOfPlyAreLimits) {
    const std::string file =
        write("cape.ply", ply("property float max_distance\nproperty double Drive_Damping\n",
                              "0 0 0 0 1\n1 0 0 0.25 2\n0 1 0 inf 3\n1 1 0 1e-3 4\n"));
    const PaintedMesh cape = load_painted_mesh(file);
    expect_values(cape.limits.max_distance, {0, 0.25, infinity, 1e-3});
    expect_values(cape.limits.drive_damping, {1, 2, 3, 4});
    EXPECT_EQ(cape.limits.drive_stiffness.size(), 0);
}

TEST_F(PaintedMeshFile, PropertiesThatCannotBeUsedAreRefused) {
    const std::string property = "property float backstop\n";
    for (const auto& [value, part] : {std::pair("-1", "vertex 1, backstop: -1"),
                                      std::pair("nan", "vertex 1, backstop: it is not a number")}) {
        const std::string file =
            write("cape.ply",
                  ply(property, std::string("0 0 0 0\n1 0 0 ") + value + "\n0 1 0 0\n1 1 0 0\n"));
        expect_load_error([&] { load_painted_mesh(file); }, file, part);
    }
}

TEST_F(PaintedMeshFile, ColoursAreReadIfAskedFor) {
    const std::string colours = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    const std::string file = write("cape.ply", ply(colours,
                                                   "0 0 0 255 255 255\n1 0 0 0 255 255\n"
                                                   "0 1 0 51 102 255\n1 1 0 255 0 51\n"));
    const PaintedMesh unread = load_painted_mesh(file);
    EXPECT_TRUE(unread.unread_colours);
    EXPECT_TRUE(unread.limits.empty());

    GoalColours settings;
    settings.max_distance = 0.5;
    settings.backstop = 0.1;
    settings.drive_stiffness = 100.0;
    settings.drive_damping = 10.0;
    const PaintedMesh cape = load_painted_mesh(file, "", FacesWithoutArea::refuse, settings);
    EXPECT_FALSE(cape.unread_colours);
    expect_values(cape.limits.max_distance, {infinity, 0, 0.1, infinity});
    expect_values(cape.limits.backstop, {infinity, infinity, 0.04, 0});
    expect_values(cape.limits.drive_stiffness, {0, 0, 0, 80});
    expect_values(cape.limits.drive_damping, {0, 0, 0, 8});
}

TEST_F(PaintedMeshFile, WhiteIsFreeCloth) {
    const std::string file =
        write("cape.obj", "v 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\nf 1 2 3\n");
    const PaintedMesh cape = load_painted_mesh(file, "", FacesWithoutArea::refuse, GoalColours());
    EXPECT_TRUE(cape.limits.empty());
    EXPECT_FALSE(cape.unread_colours);
}

TEST_F(PaintedMeshFile, ColoursOfObjAndGltfAreReadToo) {
    const std::string obj =
        write("cape.obj", "v 0 0 0 0 1 1\nv 1 0 0 0.5 1 1\nv 0 1 0 1 1 1\nf 1 2 3\n");
    const auto read = [](const std::string& file) {
        return load_painted_mesh(file, "", FacesWithoutArea::refuse, GoalColours()).limits;
    };
    expect_values(read(obj).max_distance, {0, 0.1, infinity});
    Square square;
    const std::uint8_t w = 255;
    square.paint<std::uint8_t>(
        "COLOR_0", {0, w, w, w, 51, w, w, w, w, w, w, w, 51, w, w, w, w, w, w, w, w, w, w, w}, 5121,
        R"(,"normalized":true)", "VEC4");
    expect_values(read(write("cape.gltf", square.gltf())).max_distance,
                  {0, 0.04, infinity, infinity});
}

TEST_F(PaintedMeshFile, AttributesComeBeforeColours) {
    const std::string file =
        write("cape.ply", ply("property float max_distance\nproperty uchar red\n"
                              "property uchar green\nproperty uchar blue\n",
                              "0 0 0 1 0 0 0\n1 0 0 2 0 0 0\n0 1 0 3 0 0 0\n1 1 0 4 0 0 0\n"));
    const PaintedMesh cape = load_painted_mesh(file, "", FacesWithoutArea::refuse, GoalColours());
    expect_values(cape.limits.max_distance, {1, 2, 3, 4});
    EXPECT_EQ(cape.limits.backstop.size(), 0);
}

TEST_F(PaintedMeshFile, ColoursOutOfRangeAreRefused) {
    const std::string file =
        write("cape.obj", "v 0 0 0 0 1 1\nv 1 0 0 7 1 1\nv 0 1 0 1 1 1\nf 1 2 3\n");
    expect_load_error([&] { load_painted_mesh(file, "", FacesWithoutArea::refuse, GoalColours()); },
                      file, "its colour is not within 0 to 1");
}

TEST_F(PaintedMeshFile, WeldedVerticesKeepTheTightestLimits) {
    TriMesh mesh{Points(6, 3), Faces(2, 3)};
    mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0, 1.00001, 0, 0, 1, 1, 0, 0, 1, 0.00001;
    mesh.faces << 0, 1, 2, 3, 4, 5;
    GoalLimits limits;
    limits.max_distance = vector_of({0.5, 0.4, 0.3, 0.2, 0.1, 0.6});
    limits.drive_stiffness = vector_of({1, 2, 3, 4, 5, 6});
    const WeldedMesh welded = weld_mesh(mesh, 1e-3);
    ASSERT_EQ(welded.mesh.vertices.rows(), 4);
    const GoalLimits joined = welded_limits(limits, welded);
    expect_values(joined.max_distance, {0.5, 0.2, 0.3, 0.1});
    expect_values(joined.drive_stiffness, {1, 4, 6, 5});
    EXPECT_EQ(joined.backstop.size(), 0);
    limits.max_distance.conservativeResize(5);
    EXPECT_THROW(welded_limits(limits, welded), ArgumentError);
}

TEST_F(PaintedMeshFile, WhatIsSavedIsReadAgain) {
    TriMesh mesh{Points(4, 3), Faces(2, 3)};
    mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 1, 1, 0.25;
    mesh.faces << 0, 1, 2, 1, 3, 2;
    GoalLimits limits;
    limits.max_distance = vector_of({0, 0.1, infinity, 3});
    limits.drive_damping = vector_of({1, 2, 3, 4});
    save_painted_ply(path("cape.ply"), mesh, limits);
    EXPECT_FALSE(std::filesystem::exists(path("cape.ply.tmp")));
    const PaintedMesh cape = load_painted_mesh(path("cape.ply"));
    EXPECT_EQ(cape.mesh.vertices, mesh.vertices);
    EXPECT_EQ(cape.mesh.faces, mesh.faces);
    EXPECT_EQ(cape.limits.max_distance, limits.max_distance);
    EXPECT_EQ(cape.limits.drive_damping, limits.drive_damping);
    EXPECT_EQ(cape.limits.backstop.size(), 0);
    expect_load_error([&] { save_painted_ply(path("none/cape.ply"), mesh, limits); }, "none",
                      "cannot be written");
}

TEST(SettingsRanges, GoalColours) {
    using S = GoalColours;
    const auto use = [](const S& settings) { settings.check(); };
    expect_range("GoalColours.max_distance", &S::max_distance, 0.001, 10.0, use);
    expect_range("GoalColours.backstop", &S::backstop, 0.001, 10.0, use);
    expect_range("GoalColours.drive_stiffness", &S::drive_stiffness, 0.0, 1e6, use);
    expect_range("GoalColours.drive_damping", &S::drive_damping, 0.0, 1e4, use);
}

}  // namespace
}  // namespace cloth::painted_mesh_test
