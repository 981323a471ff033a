// Your garment on your character: any rigged character file, any garment mesh file, a Bullet world.
//
//     hello_character --character dancer.glb --garment skirt.obj --pin 0.95 1.10
//
// Without options a cape hangs from the shoulders of a person of Debian's assimp-testmodels.
// data/README.md explains every step.
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "bullet_ext/btGnnSoftBodySolver.h"
#include "bullet_ext/garmentSoftBody.h"
#include "data/body/garment_fit.h"
#include "data/body/garment_skinning.h"
#include "data/body/skin_binding.h"
#include "data/body/welded_character.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/core/surface_distance.h"
#include "data/core/weld.h"
#include "data/files/mesh_io.h"
#include "data/files/painted_mesh.h"
#include "demos/dressing_checks.h"
#include "gnn/model/make_cloth.h"

namespace {

constexpr double longest = 3600.0;  // s

struct Options {
    std::string character, garment, garment_mesh, fabric = "soft", solver = "small", out;
    cloth::CharacterSettings skin;
    double garment_scale = 1.0, weld = 1e-4, clearance = 4.5e-3, settle = 0.5, seconds = 0.0;
    std::vector<double> pin;  // lowest and highest pinned vertex (m), or empty
};

/// What is printed at the end.
struct Outcome {
    cloth::WornState end;
    double inside = 0.0, deepest = 0.0;  // (m): at the end, at any time
    long failed = 0;
};

cloth::WeldedCharacter load_skin(const Options& options) {
    cloth::WeldedCharacter skin(options.character, options.skin, options.weld);
    if (options.seconds == 0.0 && !(skin.duration() <= longest))
        throw cloth::LoadError(options.character, "",
                               "its animation is longer than an hour, by the time of its last key",
                               "give --seconds, or mend the times when exporting");
    cloth::check_height(options.character, skin);
    cloth::check_surface(options.character, skin);
    std::printf("character  %s: %d vertices, %.2f m high, ", options.character.c_str(),
                static_cast<int>(skin.rest().vertices.rows()), skin.height());
    skin.duration() > 0.0 ? std::printf("animation of %.2f s\n", skin.duration())
                          : std::printf("no animation: it stands\n");
    for (const std::string& note : cloth::character_notes(options.character, skin))
        std::printf("%s\n", note.c_str());
    return skin;
}

cloth::Garment load_garment(const Options& options) {
    cloth::PaintedMesh painted = cloth::load_painted_mesh(options.garment, options.garment_mesh);
    painted.mesh.vertices *= options.garment_scale;
    const cloth::WeldedMesh welded = cloth::weld_mesh(painted.mesh, options.weld);
    const cloth::Fabric fabric =
        options.fabric == "real" ? cloth::Fabric::real_cotton() : cloth::Fabric::soft_cotton();
    cloth::Garment garment(options.garment, welded.mesh, fabric,
                           cloth::vertices_between(welded.mesh.vertices, options.pin));
    garment = garment.with_goals(cloth::welded_limits(painted.limits, welded));
    if (garment.has_goals()) std::printf("goals      are painted on it: it stays near the skin\n");
    std::printf(
        "garment    %s: %d vertices (%d near ones joined), edges of %.0f mm, %.0f g, %d pinned\n",
        options.garment.c_str(), static_cast<int>(garment.vertex_count()), welded.merged,
        1e3 * garment.mean_edge_length(), 1e3 * garment.masses().sum(),
        static_cast<int>(garment.pins().size()));
    return garment;
}

/// The garment on the first pose of the animation, clear of the skin.
cloth::ClothState dress(const cloth::Garment& garment, const cloth::WeldedCharacter& skin,
                        double clearance) {
    const double away = cloth::distance_to_skin(garment, skin);
    cloth::GarmentFitSettings settings;
    settings.clearance = clearance;
    cloth::ClothState start = cloth::ClothState::at_rest(garment);
    start.x = cloth::fit_garment(garment.rest(), skin.rest(), skin.vertices(0.0), settings);
    std::printf("fit        as modelled %.1f mm from the skin, now %.1f mm or more\n", 1e3 * away,
                1e3 * clearance);
    return start;
}

btGnnSoftBodySolver make_solver(const std::string& name) {
    cloth::ClothSettings settings;
    if (name != "quasi-newton")
        settings.weights = std::make_shared<const cloth::EngineWeights>(
            cloth::Weights::load(cloth::asset_path("weights/" + name + ".safetensors")));
    return btGnnSoftBodySolver(
        [settings](const cloth::Garment& garment) { return cloth::make_cloth(garment, settings); });
}

cloth::Points places_of(const cloth::Garment& garment, const btSoftBody& body) {
    cloth::ClothState state = cloth::ClothState::at_rest(garment);
    cloth::storeState(body, state);
    return state.x;
}

/// What can be looked at in a modeller: garment and character.
std::vector<std::string> end_files(const std::string& folder) {
    return {folder + "/garment.obj", folder + "/character.obj"};
}

Outcome run(const Options& options, const cloth::WeldedCharacter& skin,
            const cloth::Garment& garment, const cloth::ClothState& start) {
    btGnnSoftBodySolver solver = make_solver(options.solver);
    btSoftBodyRigidBodyCollisionConfiguration config;
    btCollisionDispatcher dispatcher(&config);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver rigidSolver;
    btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &rigidSolver, &config, &solver);
    world.getWorldInfo().m_gravity = {0, -9.81f, 0};
    world.getWorldInfo().m_sparsesdf.Initialize();

    // The character's skin replaces the shape of this object before every step.
    btSphereShape anywhere(1.0f);
    btRigidBody person(0, nullptr, &anywhere);
    person.setFriction(0.5f);
    world.addRigidBody(&person);
    btSoftBody* cloth = cloth::createGarmentSoftBody(world.getWorldInfo(), garment, start);
    world.addSoftBody(cloth);
    solver.attach(cloth, garment);

    // Pinned vertices ride on the skin.
    const std::vector<int>& pins = garment.pins();
    const cloth::SkinBinding band({skin.vertices(0.0), *skin.faces()}, start.x(pins, Eigen::all));
    // Painted limits count from where the skin would take the garment.
    const cloth::GarmentSkinning skinning = cloth::skin_garment(garment.rest().vertices, skin);

    constexpr double dt = 1.0 / 30.0;
    const double length = skin.duration() > 0.0 ? skin.duration() : 3.0;
    const double end = options.settle + (options.seconds > 0 ? options.seconds : length);
    Outcome outcome;
    double skin_time = 0.0;  // of the end of the last step, which may lie beyond `end`
    for (int frame = 0; frame * dt < end; ++frame) {
        // The first pose is held for a while, so that the cloth comes to hang.
        const double now = std::max(0.0, frame * dt - options.settle);
        const double next = std::max(0.0, (frame + 1) * dt - options.settle);
        solver.setAnimatedObstacle(&person, skin.faces(), skin.vertices(now), skin.vertices(next),
                                   dt);
        const cloth::Points places = band.positions(skin.vertices(next));
        for (size_t p = 0; p < pins.size(); ++p) {
            const auto row = static_cast<Eigen::Index>(p);
            cloth->m_nodes[pins[p]].m_x.setValue(static_cast<float>(places(row, 0)),
                                                 static_cast<float>(places(row, 1)),
                                                 static_cast<float>(places(row, 2)));
        }
        if (garment.has_goals())
            solver.setGoals(cloth, cloth::skinned_goals(skinning, skin, now, next), dt);
        world.stepSimulation(static_cast<btScalar>(dt), 0);
        skin_time = next;
        outcome.inside = solver.status().maxPenetration;
        outcome.deepest = std::max(outcome.deepest, outcome.inside);
    }
    outcome.failed = solver.status().failedSteps + (solver.status().clothBodies == 1 ? 0 : 1);
    const cloth::TriMesh last{skin.vertices(skin_time), *skin.faces()};
    const cloth::TriMesh worn{places_of(garment, *cloth), garment.rest().faces};
    outcome.end = cloth::worn_state(garment, worn.vertices, last);
    for (const btGnnSolverMessage& message : solver.status().messages)
        std::printf("%s\n", message.text.c_str());
    if (!options.out.empty()) {
        const std::vector<std::string> files = end_files(options.out);
        cloth::save_obj(files[0], worn);
        cloth::save_obj(files[1], last);
    }
    world.removeSoftBody(cloth);
    delete cloth;
    world.removeRigidBody(&person);
    return outcome;
}

int read_options(int argc, char** argv, Options& options) {
    CLI::App app("Your garment on your character in a Bullet world.", "hello_character");
    app.add_option("--character", options.character, "rigged and animated file (.glb, .fbx, ...)");
    app.add_option("--skin", options.skin.mesh_name, "its mesh that is skin; all if not given");
    app.add_option("--animation", options.skin.animation, "its animation; the first if not given");
    app.add_option("--character-scale", options.skin.scale, "metres per unit of the file");
    app.add_option("--garment", options.garment,
                   "mesh modelled on the character (.obj, .ply, ...)");
    app.add_option("--garment-mesh", options.garment_mesh, "its mesh; all if not given");
    app.add_option("--garment-scale", options.garment_scale, "metres per unit of the file");
    app.add_option("--weld", options.weld, "vertices as near as this become one (m)");
    app.add_option("--clearance", options.clearance, "from skin to cloth at the start (m)");
    app.add_option("--pin", options.pin, "lowest and highest vertex that rides on the skin (m)")
        ->expected(2);
    app.add_option("--fabric", options.fabric, "soft cotton, or real: cotton as measured")
        ->check(CLI::IsMember({"soft", "real"}));
    app.add_option("--solver", options.solver, "with or without a network")
        ->check(CLI::IsMember({"small", "quasi-newton"}));
    app.add_option("--settle", options.settle, "the first pose is held for so long (s)");
    app.add_option("--seconds", options.seconds,
                   "length of the run; if not given, the animation's, or 3 s");
    app.add_option("--out", options.out, "folder for garment.obj and character.obj at the end")
        ->check(CLI::ExistingDirectory);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    cloth::check_range("--weld", options.weld, 0.0, 0.01);
    cloth::check_range("--clearance", options.clearance, 1e-3, 0.05);
    cloth::check_range("--garment-scale", options.garment_scale, 1e-6, 1e6);
    cloth::check_range("--settle", options.settle, 0.0, 60.0);
    cloth::check_range("--seconds", options.seconds, 0.0, longest);
    if (options.character.empty() != options.garment.empty())
        throw cloth::ArgumentError("options", "only one of --character and --garment is given",
                                   "give both: the garment has to be modelled on the character");
    if (options.character.empty()) {
        options.character = cloth::model_path("X/BCN_Epileptic.X");
        options.garment = cloth::asset_path("garments/cape.obj");
        if (options.pin.empty()) options.pin = {0.39, 1.0};  // the upper seam
    }
    if (!options.out.empty())
        cloth::check_not_overwritten("--out " + options.out, end_files(options.out),
                                     {options.garment, options.character}, "give another folder");
    return -1;
}

}  // namespace

int main(int argc, char** argv) try {
    Options options;
    const int done = read_options(argc, argv, options);
    if (done >= 0) return done;
    const cloth::WeldedCharacter skin = load_skin(options);
    const cloth::Garment garment = load_garment(options);
    const cloth::ClothState start = dress(garment, skin, options.clearance);
    const Outcome outcome = run(options, skin, garment, start);
    std::printf("at the end stretched to %.2f (99 %% of the edges: %.2f) of the rest length\n",
                outcome.end.stretch, outcome.end.stretch99);
    std::printf("deepest point inside the character: %.2f mm, at any time %.2f mm\n",
                1e3 * outcome.inside, 1e3 * outcome.deepest);
    if (outcome.failed > 0) std::printf("%ld steps failed\n", outcome.failed);
    const std::string problem = cloth::worn_problem(outcome.end, outcome.failed);
    std::printf("%s\n", problem.empty() ? "the garment is worn" : problem.c_str());
    return problem.empty() ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "hello_character: %s\n", error.what());
    return 2;
}
