#include "tests/fuzz/fuzz_meshes.h"

#include <limits>

#include "tests/test_meshes.h"

namespace cloth::test {
namespace {

using Defect = void (*)(TriMesh&, Random&);

Eigen::Index any_face(const TriMesh& mesh, Random& random) {
    return static_cast<Eigen::Index>(random.below(static_cast<size_t>(mesh.faces.rows())));
}

int any_vertex(const TriMesh& mesh, Random& random) {
    return static_cast<int>(random.below(static_cast<size_t>(mesh.vertices.rows())));
}

void add_face(TriMesh& mesh, int a, int b, int c) {
    mesh.faces.conservativeResize(mesh.faces.rows() + 1, 3);
    mesh.faces.bottomRows<1>() << a, b, c;
}

int add_vertex(TriMesh& mesh, const Vec3& x) {
    mesh.vertices.conservativeResize(mesh.vertices.rows() + 1, 3);
    mesh.vertices.bottomRows<1>() = x;
    return static_cast<int>(mesh.vertices.rows()) - 1;
}

TriMesh sheet(int rows, int columns) {
    TriMesh mesh{Points(rows * columns, 3), Faces(0, 3)};
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) mesh.vertices.row(r * columns + c) << c, 0.0, r;
    for (int r = 0; r + 1 < rows; ++r)
        for (int c = 0; c + 1 < columns; ++c) {
            const int at = r * columns + c;
            add_face(mesh, at, at + columns, at + 1);
            add_face(mesh, at + 1, at + columns, at + columns + 1);
        }
    return mesh;
}

TriMesh joined(const TriMesh& a, const TriMesh& b) {
    TriMesh mesh = a;
    mesh.vertices.conservativeResize(a.vertices.rows() + b.vertices.rows(), 3);
    mesh.faces.conservativeResize(a.faces.rows() + b.faces.rows(), 3);
    mesh.vertices.bottomRows(b.vertices.rows()) = b.vertices.array() + 0.5;
    mesh.faces.bottomRows(b.faces.rows()) = b.faces.array() + static_cast<int>(a.vertices.rows());
    return mesh;
}

TriMesh piece(Random& random) {
    switch (random.between(0, 5)) {
        case 0:
            return sheet(2, 2);
        case 1:
            return test::cube();
        case 2:
            return test::icosphere(random.between(0, 1));
        case 3:
            return test::triangle_soup(test::cube());
        case 4: {
            TriMesh triangle = sheet(2, 2);
            triangle.vertices.conservativeResize(3, 3);
            triangle.faces.conservativeResize(1, 3);
            return triangle;
        }
        default:
            return sheet(random.between(2, 6), random.between(2, 7));
    }
}

void duplicate_face(TriMesh& mesh, Random& random) {
    const auto face = mesh.faces.row(any_face(mesh, random)).eval();
    add_face(mesh, face[0], face[1], face[2]);
}

void turn_faces_over(TriMesh& mesh, Random& random) {
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
        if (random.chance(0.3)) std::swap(mesh.faces(f, 0), mesh.faces(f, 1));
}

void add_fin(TriMesh& mesh, Random& random) {  // a third face at an edge
    const auto face = mesh.faces.row(any_face(mesh, random)).eval();
    add_face(mesh, face[0], face[1], add_vertex(mesh, Vec3(0.1, 1.0, 0.2)));
}

void add_loose_vertex(TriMesh& mesh, Random&) {
    add_vertex(mesh, Vec3(0.3, 0.7, 0.1));
}

void add_slit_face(TriMesh& mesh, Random& random) {  // two corners are one
    const int a = any_vertex(mesh, random);
    add_face(mesh, a, a, any_vertex(mesh, random));
}

void make_needle(TriMesh& mesh, Random& random) {
    const auto face = mesh.faces.row(any_face(mesh, random)).eval();
    const double height = random.magnitude(1e-13, 1e-2);
    mesh.vertices.row(face[2]) =
        (1.0 - height) * 0.5 * (mesh.vertices.row(face[0]) + mesh.vertices.row(face[1])) +
        height * mesh.vertices.row(face[2]);
}

void merge_places(TriMesh& mesh, Random& random) {
    mesh.vertices.row(any_vertex(mesh, random)) = mesh.vertices.row(any_vertex(mesh, random));
}

void spoil_index(TriMesh& mesh, Random& random) {
    const int count = static_cast<int>(mesh.vertices.rows());
    mesh.faces(any_face(mesh, random), random.between(0, 2)) =
        random.one_of<int>({-1, count, count + 7, 2147483647, -2147483647 - 1});
}

void spoil_coordinate(TriMesh& mesh, Random& random) {
    using Limits = std::numeric_limits<double>;
    mesh.vertices(any_vertex(mesh, random), random.between(0, 2)) = random.one_of<double>(
        {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(), 1e308, 1e160, 1e30, 1e-310});
}

void crumple(TriMesh& mesh, Random& random) {
    for (Eigen::Index i = 0; i < mesh.vertices.size(); ++i)
        mesh.vertices.data()[i] += random.uniform(-0.4, 0.4);
}

void remove_faces(TriMesh& mesh, Random& random) {
    mesh.faces.conservativeResize(
        static_cast<Eigen::Index>(random.below(static_cast<size_t>(mesh.faces.rows()))), 3);
}

constexpr Defect defects[] = {duplicate_face,   turn_faces_over, add_fin,     add_loose_vertex,
                              add_slit_face,    make_needle,     make_needle, merge_places,
                              spoil_coordinate, remove_faces,    crumple};

}  // namespace

TriMesh random_mesh(Random& random) {
    TriMesh mesh = piece(random);
    for (int more = random.one_of<int>({0, 0, 0, 1, 2}); more > 0; --more)
        mesh = joined(mesh, piece(random));
    if (random.chance(0.5)) crumple(mesh, random);
    const double scale = random.magnitude(1e-3, 1e3) / mesh.vertices.cwiseAbs().maxCoeff();
    mesh.vertices *= scale;
    if (random.chance(0.2)) mesh.vertices.rowwise() += 1e3 * Eigen::RowVector3d(1.0, -1.0, 0.3);
    const auto has_faces = [&] { return mesh.faces.rows() > 0; };
    for (int count = random.one_of<int>({0, 0, 1, 1, 2}); count > 0 && has_faces(); --count)
        defects[random.below(std::size(defects))](mesh, random);
    if (has_faces() && random.chance(0.05)) spoil_index(mesh, random);
    return mesh;
}

TriMesh plain_sheet(int n) {
    TriMesh mesh = sheet(n, n);
    mesh.vertices *= 0.05;
    return mesh;
}

Fabric random_fabric(Random& random) {
    if (random.chance(0.3)) return Fabric::soft_cotton();
    return {random.magnitude(0.03, 1.0), random.magnitude(1.0, 1e4), random.magnitude(1.0, 1e4),
            random.magnitude(1e-8, 1e-2)};
}

std::vector<int> random_pins(Random& random, int count) {
    const double share = random.one_of<double>({0.0, 0.1, 0.5, 1.0});
    std::vector<int> pins;
    for (int i = 0; i < count; ++i)
        if (random.chance(share)) pins.push_back(i);
    if (random.chance(0.03)) pins.push_back(random.one_of<int>({-1, count, 2147483647}));
    if (random.chance(0.1) && !pins.empty()) pins.push_back(pins.front());
    return pins;
}

}  // namespace cloth::test
