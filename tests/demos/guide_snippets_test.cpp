// The code of the guides that is in no demo: docs_test compares it with the pages, word for word.
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <gtest/gtest.h>

#include <cstdint>

#include "bullet_ext/btGnnSoftBodySolver.h"
#include "bullet_ext/garmentSoftBody.h"
#include "bullet_ext/softBodyGarment.h"
#include "collision/response/embedded_mesh.h"
#include "data/authoring/make_proxy.h"
#include "data/authoring/sheet.h"
#include "data/body/garment_skinning.h"
#include "data/body/smpl_body.h"
#include "data/core/errors.h"
#include "data/core/garment_pieces.h"
#include "data/core/paths.h"
#include "data/files/cache_writer.h"
#include "data/files/garment_assets.h"
#include "data/files/mesh_io.h"
#include "data/files/point_cache_reader.h"
#include "gnn/model/make_cloth.h"
#include "gnn/model/make_proxy_cloth.h"
#include "gnn/physics/stepper/embedded_stepper.h"
#include "gnn/physics/xpbd/xpbd_stepper.h"
#include "tests/bullet_ext/bullet_world.h"
#include "tests/data/body/smpl_files.h"

namespace cloth::guide_snippets_test {

namespace {

/// A soft body, an object for a character and a moving strip of skin.
class GuideSnippets : public testing::Test {
 protected:
    GuideSnippets() : solver(quasi_newton()), world(&solver) {
        body = world.add(btSoftBodyHelpers::CreatePatch(world.info(), {-0.4f, 1, -0.4f},
                                                        {0.4f, 1, -0.4f}, {-0.4f, 1, 0.4f},
                                                        {0.4f, 1, 0.4f}, 9, 9, 1 + 2, true));
    }

    static cloth::StepperFactory quasi_newton() {
        return [](const cloth::Garment& garment) { return cloth::make_cloth(garment); };
    }

    void expect_stepped() {
        world->stepSimulation(1.0f / 30, 0);
        EXPECT_EQ(solver.status().clothBodies, 1);
        EXPECT_EQ(solver.status().failedSteps, 0);
    }

    btGnnSoftBodySolver solver;
    cloth::test::World world;
    btSoftBody* body = nullptr;
};

}  // namespace

TEST_F(GuideSnippets, Limbs) {
    constexpr double dt = 1.0 / 30.0;
    auto sphere = std::make_unique<btSphereShape>(1.0f);
    btRigidBody person(0, nullptr, sphere.get());
    world->addRigidBody(&person);
    const cloth::TriMesh shirt = cloth::load_garment_mesh("tshirt_1000");
    const auto faces = std::make_shared<const cloth::Faces>(shirt.faces);
    const cloth::Points x0 = shirt.vertices, x1 = x0.array() + 0.001;
    // One number from 0 to 31 for each face: the part of the body that it belongs to.
    auto limbs = std::make_shared<const std::vector<std::uint8_t>>(faces->rows(), std::uint8_t{0});
    solver.setAnimatedObstacle(&person, faces, x0, x1, dt, limbs);
    expect_stepped();
    solver.removeAnimatedObstacle(&person);
    world->removeRigidBody(&person);
}

TEST_F(GuideSnippets, AFineMeshFollowsTheSoftBody) {
    solver.attach(body);
    const cloth::Garment coarse = *solver.garmentOf(body);
    const cloth::TriMesh fine = coarse.rest();
    int drawings = 0;
    const auto draw = [&](const cloth::Points& x, const cloth::Points& normals,
                          const cloth::Faces&) { drawings += x.rows() == normals.rows(); };
    solver.attach(body, coarse);
    auto drawn = std::make_shared<cloth::EmbeddedMesh>(coarse.rest(), fine);
    solver.follow(body, drawn);
    world->stepSimulation(1.0f / 60, 0);
    draw(drawn->vertices(), drawn->normals(), drawn->faces());
    EXPECT_EQ(drawings, 1);
    EXPECT_LT((drawn->vertices() - cloth::nodePositions(*body)).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_F(GuideSnippets, LevelOfDetail) {
    expect_stepped();
    for (const bool visible : {true, false}) {
        const double distance = 20.0;
        if (!visible)
            solver.setDetail(body, btGnnDetail::offScreen());
        else
            solver.setDetail(body, distance < 10 ? btGnnDetail::full() : btGnnDetail::reduced());
        world->stepSimulation(1.0f / 60, 0);
        EXPECT_EQ(solver.status().carriedBodies, visible ? 0 : 1);
    }
}

TEST_F(GuideSnippets, SimulateCoarseShowFine) {
    const cloth::Garment shirt("sheet", cloth::make_sheet(1.0, 1.0, 3000),
                               cloth::Fabric::soft_cotton());
    cloth::ClothState state = cloth::ClothState::at_rest(shirt);
    cloth::Boundary boundary;
    boundary.pin_targets.resize(0, 3);
    const double dt = 1.0 / 30.0;
    const auto proxy = std::make_shared<const cloth::Garment>(cloth::make_proxy(shirt));
    cloth::EmbeddedStepper stepper(shirt, proxy, cloth::make_cloth(*proxy));
    const cloth::StepReport report = stepper.step(boundary, dt, state);  // of the shirt
    EXPECT_TRUE(report.finite);
    EXPECT_LT(state.x.col(1).maxCoeff(), -0.005);

    const std::string file = cloth::asset_path("weights/small_detail.safetensors");
    cloth::ProxyClothSettings settings;  // one iteration of the fine garment's own step
    settings.detail = std::make_shared<const cloth::EngineWeights>(cloth::Weights::load(file));
    const auto detailed = cloth::make_proxy_cloth(shirt, proxy, settings);
    EXPECT_TRUE(detailed->step(boundary, dt, state).finite);
    EXPECT_LT(state.x.col(1).maxCoeff(), -0.02);

    const std::string small60 = cloth::asset_path("weights/small60.safetensors");
    const auto carried = cloth::make_proxy_cloth(
        shirt, proxy,
        cloth::ProxyClothSettings::learned(
            std::make_shared<const cloth::EngineWeights>(cloth::Weights::load(small60))));
    EXPECT_EQ(carried->name().rfind("small60+2s60~", 0), 0u) << carried->name();
    EXPECT_TRUE(carried->step(boundary, dt, state).finite);
    EXPECT_LT(state.x.col(1).maxCoeff(), -0.04);
}

TEST_F(GuideSnippets, PointsOfAnAnimationSystemOfYourOwn) {
    const std::vector<float> skinned = {0, 1, 2, 3, 4, 5};
    const int vertex_count = 2;
    cloth::Points x0(vertex_count, 3);
    for (int i = 0; i < vertex_count; ++i)
        x0.row(i) << skinned[3 * i], skinned[3 * i + 1], skinned[3 * i + 2];
    EXPECT_EQ(x0, (cloth::Points(2, 3) << 0, 1, 2, 3, 4, 5).finished());
}

TEST_F(GuideSnippets, Fabric) {
    // Throws an error that says what is wrong with the body; without attach(), status() says it.
    solver.attach(body, cloth::Fabric::real_cotton());
    EXPECT_EQ(solver.garmentOf(body)->fabric().mu, cloth::Fabric::real_cotton().mu);
    expect_stepped();
}

TEST_F(GuideSnippets, GoingBack) {
    solver.attach(body);
    solver.attach(body, cloth::Garment(*solver.garmentOf(body)));
    expect_stepped();
}

TEST_F(GuideSnippets, ClothesThatFollowTheSkin) {
    const double now = 0.0, dt = 1.0 / 30.0;
    const cloth::WeldedCharacter character(cloth::model_path("glTF2/simple_skin/simple_skin.gltf"),
                                           {}, 1e-4);
    const cloth::Points worn = cloth::nodePositions(*body);
    cloth::GoalLimits limits;
    limits.max_distance.setConstant(body->m_nodes.size(), 0.1);  // m
    limits.backstop.setConstant(body->m_nodes.size(), 0.02);     // m
    solver.setGoalLimits(body, limits);
    const cloth::GarmentSkinning skinning = cloth::skin_garment(worn, character);
    solver.setGoals(body, cloth::skinned_goals(skinning, character, now, now + dt), dt);
    world->stepSimulation(static_cast<btScalar>(dt), 0);
    EXPECT_LT((cloth::nodePositions(*body) - worn).rowwise().norm().maxCoeff(), 0.11);
    EXPECT_TRUE(solver.status().messages.empty());
}

TEST_F(GuideSnippets, FadingToTheSkin) {
    const double now = 0.0, dt = 1.0 / 30.0;
    const cloth::WeldedCharacter character(cloth::model_path("glTF2/simple_skin/simple_skin.gltf"),
                                           {}, 1e-4);
    const cloth::GarmentSkinning skinning =
        cloth::skin_garment(cloth::nodePositions(*body), character);
    solver.fadeToSkin(body, /*weight=*/1.0, /*seconds=*/0.5);  // 0: simulated, 1: skinned
    solver.setGoals(body, cloth::skinned_goals(skinning, character, now, now + dt), dt);
    world->stepSimulation(static_cast<btScalar>(dt), 0);
    const cloth::Points shown = solver.shownPositions(body);
    const cloth::Points nodes = cloth::nodePositions(*body);
    const cloth::Points goals = cloth::skinned_goals(skinning, character, now, now + dt).x1;
    EXPECT_LT((shown - (nodes + (goals - nodes) * (dt / 0.5))).rowwise().norm().maxCoeff(), 1e-9);
    EXPECT_TRUE(solver.status().messages.empty());
}

TEST_F(GuideSnippets, Status) {
    expect_stepped();
    const btGnnSolverStatus& status = solver.status();
    for (const btGnnSolverMessage& message : status.messages)
        std::printf("%s (%d times)\n", message.text.c_str(), message.count);
    std::printf("%d bodies, %ld steps, %ld failed, %.1f mm inside, %.1f ms\n", status.clothBodies,
                status.steps, status.failedSteps, 1e3 * status.maxPenetration,
                status.times.total());
    EXPECT_TRUE(status.messages.empty());
}

TEST_F(GuideSnippets, SelfContact) {
    const auto weights = std::make_shared<const cloth::EngineWeights>(
        cloth::Weights::load(cloth::asset_path("weights/small.safetensors")));
    cloth::ClothSettings settings;
    settings.weights = weights;
    settings.step.potential.self_contact.thickness = 4e-3;  // m
    settings.step.potential.integrator = cloth::Integrator::bdf2;
    const auto factory = [&](const cloth::Garment& garment) {
        return cloth::make_cloth(garment, settings);
    };
    // A shirt over a shirt: one garment of two pieces, which feel each other.
    const cloth::Garment shirt = cloth::load_garment("tshirt_1000");
    const cloth::MergedGarments both = cloth::merge_garments("both", {shirt, shirt});
    btSoftBody* layers = cloth::createGarmentSoftBody(world.info(), both.garment);
    world.remove(body);
    world.add(layers);
    solver.attach(layers, both.garment, factory);
    EXPECT_EQ(both.first_vertex[1], shirt.vertex_count());
    EXPECT_EQ(layers->m_nodes.size(), 2 * shirt.vertex_count());
}

TEST_F(GuideSnippets, Wardrobe) {
    const cloth::Garment pants = cloth::load_garment("pants_1000");
    cloth::ClothState state = cloth::load_garment_start("pants_1000");
    EXPECT_EQ(state.x.rows(), pants.vertex_count());
    EXPECT_NE(state.x, pants.rest().vertices);
}

TEST_F(GuideSnippets, Cache) {
    constexpr int frames = 3;
    const std::string folder = testing::TempDir();
    const std::string file = folder + "/guide_cache.pc2", rest_file = folder + "/guide_rest.obj";
    const cloth::Garment shirt = cloth::load_garment("tshirt_1000");
    btSoftBody* node_by_node = cloth::createGarmentSoftBody(world.info(), shirt);
    world.add(node_by_node);
    solver.attach(node_by_node, shirt);
    cloth::save_obj(rest_file, shirt.rest());
    const auto cache = cloth::make_cache_writer(file, shirt.rest(), {/*rate=*/30, frames});
    cloth::ClothState state = cloth::ClothState::at_rest(shirt);
    for (int frame = 0; frame < frames; ++frame) {
        cloth::storeState(*node_by_node, state);
        cache->add(state.x);
        world->stepSimulation(1.0f / 30, 0);
    }
    cache->finish();
    cloth::PointCacheReader read(file);
    EXPECT_EQ(read.frames(), frames);
    EXPECT_GT(read.frame(0).col(1).mean(), read.frame(2).col(1).mean()) << "it falls";
    std::remove(file.c_str());
    std::remove(rest_file.c_str());
}

TEST_F(GuideSnippets, TimeLimit) {
    const auto physics = [](const cloth::Garment& garment) { return cloth::make_cloth(garment); };
    btGnnSolverSettings settings;
    settings.maxMs = 8.0;  // of a world step, from now on
    btGnnSoftBodySolver limited(physics, settings);
    EXPECT_EQ(limited.status().shortenedSteps, 0);
    settings.maxMs = 0.0;
    EXPECT_THROW(btGnnSoftBodySolver(physics, settings), cloth::ArgumentError);
}

TEST_F(GuideSnippets, ClothThatTouchesCloth) {
    const auto physics = [](const cloth::Garment& garment) { return cloth::make_cloth(garment); };
    btGnnSolverSettings touching;
    touching.layerThickness = 6e-3;  // m; 0: cloth passes through cloth
    btGnnSoftBodySolver layered(physics, touching);
    EXPECT_EQ(layered.status().touchingPairs, 0);
    touching.layerThickness = 0.1;
    EXPECT_THROW(btGnnSoftBodySolver(physics, touching), cloth::ArgumentError);
}

TEST_F(GuideSnippets, BodiesOfSmpl) {
    const std::string model_file = testing::TempDir() + "guide_model.npz",
                      motion_file = testing::TempDir() + "guide_motion.npz";
    cloth::test::write_npz(model_file, cloth::test::small_smpl_model());
    cloth::test::write_npz(motion_file, cloth::test::small_amass_motion());
    cloth::Boundary outside;
    const double t = 0.5, dt = 1.0 / 30.0;
    const auto model = std::make_shared<const cloth::SmplModel>(cloth::SmplModel::load(model_file));
    const cloth::SmplBody person(model, cloth::AmassMotion::load(motion_file));
    outside.obstacles = {person.obstacle(t, t + dt)};
    EXPECT_EQ(outside.obstacles[0].x1.rows(), 16);
    EXPECT_NO_THROW(cloth::check_obstacles(outside));
}

TEST_F(GuideSnippets, Solvers) {
    const auto weights = std::make_shared<const cloth::EngineWeights>(
        cloth::Weights::load(cloth::asset_path("weights/small.safetensors")));
    const auto small = [&](const cloth::Garment& garment) {
        cloth::ClothSettings settings;
        settings.weights = weights;
        return cloth::make_cloth(garment, settings);
    };
    const auto physics = [](const cloth::Garment& garment) {
        return cloth::make_cloth(garment);  // the default
    };
    const auto whole_steps = [](const cloth::Garment& garment) {  // quasi-newton
        cloth::ClothSettings settings;
        settings.step = cloth::StepSettings::whole();
        return cloth::make_cloth(garment, settings);
    };
    const auto bdf2 = [](const cloth::Garment& garment) {  // quasi-newton-bdf2
        cloth::ClothSettings settings;
        settings.step = cloth::StepSettings::whole();
        settings.step.potential.integrator = cloth::Integrator::bdf2;
        return cloth::make_cloth(garment, settings);
    };
    const auto xpbd = [](const cloth::Garment& garment) {  // xpbd-40
        cloth::XpbdSettings settings;
        settings.substeps = 40;
        return std::make_unique<cloth::XpbdStepper>(garment, settings);
    };
    const auto xpbd_layers = [](const cloth::Garment& garment) {  // xpbd-40 that feels itself
        cloth::XpbdSettings settings;
        settings.substeps = 40;
        settings.self_contact.thickness = 4e-3;  // m
        return std::make_unique<cloth::XpbdStepper>(garment, settings);
    };
    const auto small_3 = [&](const cloth::Garment& garment) {  // small+3
        cloth::ClothSettings settings;
        settings.weights = weights;
        settings.step = cloth::StepSettings::whole(cloth::IterationLimits::exactly(3));
        settings.guard.max_substeps = 1;  // no step is cut or searched
        return cloth::make_cloth(garment, settings);
    };
    const auto reference = [](const cloth::Garment& garment) {
        return std::make_unique<cloth::ClothStepper>(garment,
                                                     cloth::ClothStepperSettings::reference());
    };
    // Learned steppers are named after the file of their network.
    const std::pair<cloth::StepperFactory, const char*> solvers[] = {
        {small, "small"},
        {physics, "quasi-newton-3s120"},
        {whole_steps, "quasi-newton"},
        {bdf2, "quasi-newton-bdf2"},
        {xpbd, "xpbd-40"},
        {xpbd_layers, "xpbd-40"},
        {small_3, "small+3"},
        {reference, "reference"}};
    for (const auto& [factory, name] : solvers) {
        solver.attach(body, cloth::Fabric::soft_cotton(), factory);
        EXPECT_EQ(solver.stepperOf(body)->name(), name);
        expect_stepped();
    }
}

}  // namespace cloth::guide_snippets_test
