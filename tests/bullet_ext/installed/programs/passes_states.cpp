// A program outside the tree. States, points and boundaries are made here, changed and kept by the
// solvers of the library, and freed on either side; see passes_meshes.cpp.
#include <BulletSoftBody/btSoftBody.h>

#include <cstdio>
#include <cstdlib>

#include "bullet_ext/garmentSoftBody.h"
#include "bullet_ext/softBodyGarment.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"

using namespace cloth;

namespace {

void expect(bool holds, const char* what) {
    if (holds) return;
    std::printf("wrong: %s\n", what);
    std::exit(1);
}

/// A sheet of n x n vertices in the plane y = `height`, with sides of 0.4 m; allocated here.
TriMesh sheet(int n, double height) {
    TriMesh mesh;
    mesh.vertices.resize(n * n, 3);
    mesh.faces.resize(2 * (n - 1) * (n - 1), 3);
    int face = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const int v = i * n + j;
            mesh.vertices.row(v) << 0.4 * j / (n - 1) - 0.2, height, 0.4 * i / (n - 1) - 0.2;
            if (i + 1 == n || j + 1 == n) continue;
            mesh.faces.row(face++) << v, v + n, v + 1;
            mesh.faces.row(face++) << v + 1, v + n, v + n + 1;
        }
    return mesh;
}

Boundary ball_and_floor() {
    Boundary boundary;
    boundary.obstacles.resize(1);
    boundary.obstacles[0].shape = ObstacleShape::sphere;
    boundary.obstacles[0].radius = 0.1;
    Obstacle floor;
    const TriMesh mesh = sheet(3, -0.2);
    floor.faces = std::make_shared<const Faces>(mesh.faces);
    floor.x0 = floor.x1 = mesh.vertices;
    boundary.obstacles.push_back(floor);
    return boundary;
}

void states_through_a_solver() {
    const Garment garment("sheet", sheet(9, 0.13), Fabric::soft_cotton(), {0});
    ClothState state = ClothState::at_rest(garment);
    {
        XpbdStepper stepper(garment);
        for (int step = 0; step < 20; ++step) {
            Boundary boundary = ball_and_floor();  // a new one each time: arrays move as they may
            boundary.pin_targets = garment.rest().vertices.topRows(1);
            boundary.accelerations.setZero(garment.vertex_count(), 3);
            boundary.ignored_limbs.assign(81, 0);
            expect(stepper.step(boundary, 1.0 / 30, state).finite, "the step is finite");
            ClothState copy = state;
            std::swap(copy, state);
        }
    }
    expect(state.x(40, 1) > 0.09 && state.x(40, 1) < 0.13, "the sheet lies on the ball");
    expect(state.x(80, 1) < 0.09, "its corner hangs");
    expect(state.x.row(0) == garment.rest().vertices.row(0), "its pin is where it was");
    state.x.conservativeResize(200, 3);
    state.v.resize(0, 3);
}

void states_through_a_soft_body() {
    btSoftBodyWorldInfo info;
    const Garment garment("sheet", sheet(5, 0), Fabric::soft_cotton());
    btSoftBody* body = createGarmentSoftBody(info, garment);
    ClothState state;  // the library gives it its size
    storeState(*body, state);
    state.x.col(1).array() += 2;
    state.x.conservativeResize(25, 3);
    loadState(state, *body);
    Points nodes = nodePositions(*body);
    expect((nodes - state.x).norm() < 1e-5, "nodes are where the state is");
    nodes.conservativeResize(50, 3);
    Garment back = garmentOfSoftBody(*body, garment.fabric(), false);
    back = back.with_fabric(Fabric::real_cotton());
    expect(back.face_count() == garment.face_count(), "the garment of the soft body");
    delete body;
}

}  // namespace

int main() {
    states_through_a_solver();
    states_through_a_soft_body();
    std::printf("states passed both ways\n");
}
