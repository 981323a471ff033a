#include "demos/viewer/viewer_scene.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

#include "demos/compare/arguments.h"
#include "demos/compare/solver_factory.h"
#include "demos/viewer/changed_garment.h"

namespace cloth {
namespace {

bool same_fabric(const Fabric& a, const Fabric& b) {
    return a.density == b.density && a.mu == b.mu && a.lambda == b.lambda && a.bending == b.bending;
}

bool same_pull(const std::optional<ViewerControls::Pull>& a,
               const std::optional<ViewerControls::Pull>& b) {
    if (!a || !b) return !a && !b;
    return a->vertex == b->vertex && a->target == b->target;
}

bool knows_goals(const std::string& solver) {
    return solver.rfind("bullet", 0) != 0;
}

}  // namespace

bool operator==(const ViewerControls& a, const ViewerControls& b) {
    const PullSettings &p = a.pull_settings, &q = b.pull_settings;
    return a.playing == b.playing && a.single_steps == b.single_steps && a.restarts == b.restarts &&
           a.body_moves == b.body_moves && a.solver == b.solver &&
           same_fabric(a.fabric, b.fabric) && a.wind == b.wind && a.colours == b.colours &&
           same_pull(a.pull, b.pull) && p.stiffness == q.stiffness && p.radius == q.radius &&
           p.max_distance == q.max_distance;
}

/// A garment and the stepper that keeps a reference to it.
struct ViewerScene::Worn {
    Worn(std::shared_ptr<const ComparisonScene> base, Garment garment)
        : scene(std::move(base), std::move(garment)) {}

    ChangedGarment scene;
    std::unique_ptr<Stepper> stepper;
};

ViewerScene::ViewerScene(const SceneOptions& options, int threads)
    : m_base(make_bake_scene(options)),
      m_threads(threads),
      m_solver(options.solver),
      m_fabric(m_base.cloth->garment().fabric()),
      m_trees(std::make_shared<ObstacleTrees>()) {
    m_asked.solver = m_solver;
    m_asked.fabric = m_fabric;
    restart();
    show(m_asked.colours);
}

ViewerScene::~ViewerScene() = default;

const Garment& ViewerScene::garment() const {
    return m_free->scene.garment();
}

std::unique_ptr<ViewerScene::Worn> ViewerScene::wear(const std::string& solver,
                                                     const Fabric& fabric,
                                                     const ClothPull* pull) const {
    Garment garment = m_base.cloth->garment().with_fabric(fabric);
    if (pull) garment = garment.with_goals(pull->limits(garment.goal_limits()));
    auto worn = std::make_unique<Worn>(m_base.cloth, std::move(garment));
    worn->stepper = make_solver(solver, worn->scene, {{}, m_threads, nullptr});
    worn->stepper->prepare(frame_time());
    return worn;
}

bool ViewerScene::advance(const ViewerControls& controls) {
    const bool single = controls.single_steps != m_asked.single_steps;
    const bool recolour = controls.colours != m_asked.colours;
    const bool restarted = controls.restarts != m_asked.restarts;
    take(controls);
    const bool stepping = (controls.playing && !restarted) || single;
    if (stepping) step(controls);
    if (stepping || recolour || restarted) show(controls.colours);
    return stepping;
}

void ViewerScene::take(const ViewerControls& controls) {
    const ViewerControls before = std::exchange(m_asked, controls);
    const auto unless_refused = [this](const auto& change) {
        try {
            change();
        } catch (const std::exception& error) {
            m_frame.refusal = error.what();
        }
    };
    if (controls.restarts != before.restarts) restart();
    if (controls.solver != before.solver || !same_fabric(controls.fabric, before.fabric)) {
        m_frame.refusal.clear();
        unless_refused([&] { use(controls.solver, controls.fabric); });
    }
    if (!(controls.wind == m_wind))
        unless_refused([&] {
            check(controls.wind);
            m_wind = controls.wind;
        });
    unless_refused([&] { take_pull(controls); });
    m_frame.is_pulled = m_pull.has_value();
}

void ViewerScene::use(const std::string& solver, const Fabric& fabric) {
    m_free = wear(solver, fabric, nullptr);
    m_solver = solver;
    m_fabric = fabric;
    release();
}

void ViewerScene::release() {
    m_pull.reset();
    m_pulled.reset();
}

void ViewerScene::take_pull(const ViewerControls& controls) {
    if (!controls.pull) return release();
    if (m_pull && m_pull->vertex() == controls.pull->vertex) return;
    release();
    if (!knows_goals(m_solver))
        throw UsageError("solver " + m_solver + ": its cloth cannot be dragged; take another one");
    const ClothPull pull(garment(), controls.pull->vertex, controls.pull_settings);
    m_pulled = wear(m_solver, m_fabric, &pull);
    m_pull = pull;
}

void ViewerScene::restart() {
    use(m_solver, m_fabric);  // steppers remember more than the state
    m_state = m_base.cloth->start();
    m_frame = {};
    m_frame.frame = -m_base.cloth->lead_in_frames();
    m_frame.solver = m_free->stepper->name();
    m_frame.counts_tangles = m_base.cloth->self_contact().on();
    const double time = motion_time(m_frame.frame);
    m_boundary = m_base.cloth->boundary(time, time);
}

Boundary ViewerScene::next_boundary(const ViewerControls& controls) const {
    const bool moves = controls.body_moves && m_frame.frame < frames();
    Boundary boundary = m_base.cloth->boundary(motion_time(m_frame.frame),
                                               motion_time(m_frame.frame + (moves ? 1 : 0)));
    boundary.trees = m_trees;
    boundary.accelerations = wind_accelerations(m_wind, garment(), m_state, frame_time());
    if (m_pull)
        boundary.goals = m_pull->goals(m_state.x, controls.pull->target, garment().goal_limits(),
                                       boundary.goals);
    return boundary;
}

void ViewerScene::step(const ViewerControls& controls) {
    m_trees->begin_step();
    m_boundary = next_boundary(controls);
    Stepper& stepper = m_pull ? *m_pulled->stepper : *m_free->stepper;
    const auto start = std::chrono::steady_clock::now();
    m_frame.report = stepper.step(m_boundary, frame_time(), m_state);
    const auto time = std::chrono::steady_clock::now() - start;
    m_frame.ms = std::chrono::duration<double, std::milli>(time).count();
    m_frame.solver = stepper.name();
    ++m_frame.steps;
    if (controls.body_moves) m_frame.frame = std::min(m_frame.frame + 1, frames());
    m_frame.problem = m_base.cloth->loss(m_boundary, m_state.x);
    if (!m_frame.report.finite)
        m_frame.problem = "the step failed: the cloth is as before it; take another solver";
}

void ViewerScene::show(ColourMode colours) {
    m_frame.time = m_state.time;
    m_frame.cloth = m_state.x;
    m_frame.skin = m_base.skin(motion_time(m_frame.frame));
    m_frame.stretch = measure_stretch(garment(), m_state.x);
    m_frame.colours = vertex_colours(colours, garment(), m_state.x, m_boundary, m_proximity);
}

}  // namespace cloth
