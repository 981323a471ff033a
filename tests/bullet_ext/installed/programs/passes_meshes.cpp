// A program outside the tree. Meshes, points and obstacles are made on one side of the library's
// border and resized, moved, copied or freed on the other. With two layouts of Eigen's memory one
// of these frees what the other side's allocator made, and glibc aborts the program.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "data/authoring/sheet.h"
#include "data/body/body_shapes.h"
#include "data/body/garment_fit.h"
#include "data/core/garment_pieces.h"
#include "data/core/moving_surface.h"
#include "data/core/surface_distance.h"
#include "data/files/mesh_io.h"

using namespace cloth;

namespace {

void expect(bool holds, const char* what) {
    if (holds) return;
    std::printf("wrong: %s\n", what);
    std::exit(1);
}

/// Two triangles in the plane y = `height`, seen from above; allocated here.
TriMesh square(double height) {
    TriMesh mesh;
    mesh.vertices.resize(4, 3);
    mesh.vertices << -1, height, -1, 1, height, -1, 1, height, 1, -1, height, 1;
    mesh.faces.resize(2, 3);
    mesh.faces << 0, 2, 1, 0, 3, 2;
    return mesh;
}

void meshes_of_the_library() {
    TriMesh sheet = make_sheet(1, 1, 100);  // made there, freed here
    const Eigen::Index count = sheet.vertices.rows();
    expect(count >= 97 && count <= 103, "size of the sheet");
    const Points before = sheet.vertices;
    sheet.vertices.conservativeResize(2 * count, 3);
    expect(sheet.vertices.topRows(count) == before, "vertices after conservativeResize");
    sheet.vertices.resize(7, 3);
    sheet = make_sheet(1, 2, 200);
    std::vector<TriMesh> sheets;
    for (int k = 0; k < 5; ++k) sheets.push_back(make_sheet(1, 1, 20 + 10 * k));
    sheets.erase(sheets.begin());
    expect(sheets.front().vertices.rows() >= 29, "sheets in a vector");
    expect(vertex_normals(sheet.vertices, sheet.faces).col(1).minCoeff() > 0.99, "normals");
}

void meshes_of_the_program() {
    const SurfaceDistance floor(square(0));  // made here, freed there
    const NearestPoint nearest = floor.nearest({0.25, 0.5, 0.125});
    expect(std::abs(nearest.distance - 0.5) < 1e-12 && nearest.normal.y() > 0.99,
           "distance to a square");

    Garment garment("square", square(1), Fabric::soft_cotton(), {0, 1});
    garment = garment.with_pins({2});  // its arrays: made there, freed here
    std::vector<Garment> layers(3, garment);
    const MergedGarments merged = merge_garments("layers", layers);
    layers.clear();
    expect(merged.garment.vertex_count() == 12 && merged.first_vertex.back() == 12,
           "merged layers");
    expect(garment.inverse_masses()(2) == 0 && garment.inverse_masses()(0) > 0, "pins");
    Garment moved = std::move(garment);
    expect(std::abs(moved.face_areas().sum() - 4) < 1e-12, "areas of a garment that was moved");
}

void meshes_of_files() {
    const auto path = std::filesystem::temp_directory_path() / "passes_meshes.obj";
    const TriMesh sheet = make_sheet(1, 1, 60);
    save_obj(path.string(), sheet);
    TriMesh read = load_mesh(path.string());
    expect(read.vertices == sheet.vertices && read.faces == sheet.faces, "a mesh that was saved");
    read.faces.conservativeResize(read.faces.rows() - 1, 3);
    std::filesystem::remove(path);

    TriMesh box = square(-1);
    Points raised = box.vertices.array() + 0.5;
    Points fitted = fit_garment(sheet, box, raised);
    expect(fitted.rows() == sheet.vertices.rows() && fitted.allFinite(),
           "a garment that was fitted");
    fitted.conservativeResize(3, 3);
}

/// A surface of the program: the library keeps what it returns.
class Lift : public MovingSurface {
 public:
    Lift() : MovingSurface(0.5), m_mesh(square(0)) {
        m_faces = std::make_shared<const Faces>(std::move(m_mesh.faces));
    }
    std::shared_ptr<const Faces> faces() const override { return m_faces; }
    Points vertices(double time) const override {
        Points x = m_mesh.vertices;
        x.col(1).array() += time;
        return x;
    }
    double duration() const override { return 2; }

 private:
    TriMesh m_mesh;
    std::shared_ptr<const Faces> m_faces;
};

void obstacles_of_both() {
    Boundary boundary;
    {
        const Lift lift;
        for (int k = 0; k < 20; ++k)  // the vector grows here
            boundary.obstacles.push_back(lift.obstacle(0.1 * k, 0.1 * (k + 1)));
    }
    Obstacle ball;
    ball.shape = ObstacleShape::sphere;
    ball.radius = 0.25;
    boundary.obstacles.insert(boundary.obstacles.begin(), ball);
    const Boundary copy = boundary;
    boundary = Boundary();
    expect(copy.obstacles.back().x1(0, 1) == 2 && copy.obstacles.front().radius == 0.25,
           "obstacles in a vector");
}

}  // namespace

int main() {
    meshes_of_the_library();
    meshes_of_the_program();
    meshes_of_files();
    obstacles_of_both();
    std::printf("meshes passed both ways\n");
}
