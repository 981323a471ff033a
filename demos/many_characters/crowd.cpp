#include "demos/many_characters/crowd.h"

#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <chrono>
#include <filesystem>

#include "bullet_ext/garmentSoftBody.h"
#include "data/body/animated_body.h"
#include "data/core/paths.h"
#include "data/files/garment_assets.h"
#include "demos/bullet_scenes/scene_solver.h"

namespace cloth {
namespace {

constexpr double distance = 2.0;  // between characters (m)
constexpr double delay = 0.1;     // from one to the next (s)

Points beside(Points x, int character) {
    x.col(0).array() += distance * character;
    return x;
}

btGnnSolverSettings solver_settings(const CrowdSettings& settings) {
    btGnnSolverSettings solver;
    solver.parallel = settings.parallel;
    return solver;
}

}  // namespace

std::vector<std::string> crowd_motions() {
    std::vector<std::string> motions = {"01_01", "01_03", "Boxing_Toes"};
    if (const auto folder = shared_data_path("motions/validation"))
        for (const std::string& file : list_motions(*folder)) motions.push_back(file);
    return motions;
}

struct Crowd::World {
    struct Character {
        std::unique_ptr<AnimatedBody> body;
        std::unique_ptr<btRigidBody> skin;
        std::unique_ptr<btSoftBody> cloth;
    };

    explicit World(std::unique_ptr<btGnnSoftBodySolver> by) : solver(std::move(by)) {
        world.getWorldInfo().m_gravity = {0, -9.81F, 0};
        world.getWorldInfo().m_sparsesdf.Initialize();
    }
    ~World() {
        for (Character& character : characters) {
            world.removeSoftBody(character.cloth.get());
            world.removeRigidBody(character.skin.get());
        }
    }
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    void add(std::unique_ptr<AnimatedBody> body, const Garment& garment, ClothState state) {
        const int number = static_cast<int>(characters.size());
        Character character;
        character.body = std::move(body);
        character.skin = std::make_unique<btRigidBody>(0.0F, nullptr, &anywhere);
        character.skin->setFriction(static_cast<btScalar>(character.body->settings().friction));
        world.addRigidBody(character.skin.get());
        state.x = beside(std::move(state.x), number);
        character.cloth.reset(createGarmentSoftBody(world.getWorldInfo(), garment, state));
        world.addSoftBody(character.cloth.get());
        solver->attach(character.cloth.get(), garment);
        characters.push_back(std::move(character));
    }

    void animate(int number) {
        const Character& character = characters[static_cast<size_t>(number)];
        const double time = frame * frame_time - delay * number;
        solver->setAnimatedObstacle(character.skin.get(), character.body->faces(),
                                    beside(character.body->vertices(time), number),
                                    beside(character.body->vertices(time + frame_time), number),
                                    frame_time, character.body->limbs());
    }

    std::unique_ptr<btGnnSoftBodySolver> solver;
    btSoftBodyRigidBodyCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver rigid_solver;
    btSoftRigidDynamicsWorld world{&dispatcher, &broadphase, &rigid_solver, &configuration,
                                   solver.get()};
    btSphereShape anywhere{1.0F};  // the skin replaces it
    std::vector<Character> characters;
    int frame = 0;
};

Crowd::Crowd(std::shared_ptr<const Body> body, const std::vector<Motion>& motions,
             const CrowdSettings& settings)
    : m_world(std::make_unique<World>(
          SceneSolvers().make(settings.solver, solver_settings(settings)))) {
    const Garment garment = load_garment(settings.garment);
    const ClothState start = load_garment_start(settings.garment);
    for (int k = 0; k < settings.characters; ++k)
        m_world->add(
            std::make_unique<AnimatedBody>(body, motions[static_cast<size_t>(k) % motions.size()]),
            garment, start);
}

Crowd::~Crowd() = default;

double Crowd::step() {
    for (int k = 0; k < static_cast<int>(m_world->characters.size()); ++k) m_world->animate(k);
    const auto start = std::chrono::steady_clock::now();
    m_world->world.stepSimulation(static_cast<btScalar>(frame_time), 0);
    ++m_world->frame;
    const auto time = std::chrono::steady_clock::now() - start;
    return std::chrono::duration<double, std::milli>(time).count();
}

const btGnnSoftBodySolver& Crowd::solver() const {
    return *m_world->solver;
}

Points Crowd::nodes(int character) const {
    ClothState state;
    storeState(*m_world->characters[static_cast<size_t>(character)].cloth, state);
    return state.x;
}

}  // namespace cloth
