// Your garment on your character: the steps that data/README.md explains, whole.
//
//     own_character dancer.glb skirt.obj 0.95 1.10
//
// pins the vertices of the skirt from 0.95 m to 1.10 m to the skin. Without heights nothing is
// pinned.
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "bullet_ext/btGnnSoftBodySolver.h"
#include "bullet_ext/garmentSoftBody.h"
#include "data/body/garment_fit.h"
#include "data/body/skin_binding.h"
#include "data/body/welded_character.h"
#include "data/core/surface_distance.h"
#include "data/core/weld.h"
#include "data/files/mesh_io.h"
#include "gnn/model/make_cloth.h"

int main(int argc, char** argv) try {
    if (argc != 3 && argc != 5) {
        std::fprintf(stderr, "usage: own_character CHARACTER GARMENT [LOW HIGH]\n");
        return 2;
    }
    const std::string character_file = argv[1], garment_file = argv[2];
    const double low = argc == 5 ? std::atof(argv[3]) : 1.0;
    const double high = argc == 5 ? std::atof(argv[4]) : 0.0;

    // 1. Load and weld the character.
    cloth::CharacterSettings settings;
    settings.scale = 1.0;  // metres per unit of the file: 0.01 for centimetres
    const cloth::WeldedCharacter skin(character_file, settings, /*weld=*/1e-4);

    // 2. Load, scale and weld the garment.
    cloth::TriMesh mesh = cloth::load_mesh(garment_file);
    mesh.vertices *= 1.0;  // metres per unit of the file
    mesh = cloth::weld_mesh(mesh, /*tolerance=*/1e-4).mesh;

    // 3. Make a garment.
    std::vector<int> pinned;
    for (int i = 0; i < mesh.vertices.rows(); ++i)
        if (mesh.vertices(i, 1) >= low && mesh.vertices(i, 1) <= high) pinned.push_back(i);
    const cloth::Garment garment("garment", mesh, cloth::Fabric::soft_cotton(), pinned);
    const double away = cloth::smallest_clearance(mesh, cloth::SurfaceDistance(skin.rest()));
    std::printf("the character is %.2f m high, the garment %.3f m from its skin\n", skin.height(),
                away);
    if (away > 0.3) return std::fprintf(stderr, "are both files in metres?\n"), 1;

    // 4. Fit it.
    cloth::ClothState start = cloth::ClothState::at_rest(garment);
    start.x = cloth::fit_garment(garment.rest(), skin.rest(), skin.vertices(0.0));

    // The world, as in the smallest program.
    btGnnSoftBodySolver solver([](const cloth::Garment& g) { return cloth::make_cloth(g); });
    btSoftBodyRigidBodyCollisionConfiguration config;
    btCollisionDispatcher dispatcher(&config);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver rigidSolver;
    btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &rigidSolver, &config, &solver);
    world.getWorldInfo().m_gravity = {0, -9.81f, 0};

    // 5. Register it.
    btSphereShape anywhere(1.0f);
    btRigidBody person(0, nullptr, &anywhere);
    person.setFriction(0.5f);
    world.addRigidBody(&person);
    btSoftBody* cloth = cloth::createGarmentSoftBody(world.getWorldInfo(), garment, start);
    world.addSoftBody(cloth);
    solver.attach(cloth, garment);

    // 6. Pin it to the skin.
    const std::vector<int>& pins = garment.pins();
    const cloth::SkinBinding band({skin.vertices(0.0), *skin.faces()}, start.x(pins, Eigen::all));

    // 7. Run: half a second in the first pose, and then the animation.
    const double dt = 1.0 / 30.0;
    for (double time = -0.5; time < skin.duration(); time += dt) {
        const double now = std::max(0.0, time), next = std::max(0.0, time + dt);
        solver.setAnimatedObstacle(&person, skin.faces(), skin.vertices(now), skin.vertices(next),
                                   dt);
        const cloth::Points places = band.positions(skin.vertices(next));
        for (size_t p = 0; p < pins.size(); ++p) {
            const auto row = static_cast<Eigen::Index>(p);
            cloth->m_nodes[pins[p]].m_x.setValue(static_cast<float>(places(row, 0)),
                                                 static_cast<float>(places(row, 1)),
                                                 static_cast<float>(places(row, 2)));
        }
        world.stepSimulation(static_cast<btScalar>(dt), 0);
    }

    for (const btGnnSolverMessage& message : solver.status().messages)
        std::printf("%s\n", message.text.c_str());
    std::printf("%ld steps, %ld of them failed; %.1f mm inside at the end\n", solver.status().steps,
                solver.status().failedSteps, 1e3 * solver.status().maxPenetration);
    const bool is_worn = solver.status().clothBodies == 1 && solver.status().failedSteps == 0;
    world.removeSoftBody(cloth);
    delete cloth;
    world.removeRigidBody(&person);
    return is_worn ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "own_character: %s\n", error.what());
    return 2;
}
