#pragma once

#include <memory>
#include <optional>
#include <string>

#include "collision/proximity/metrics.h"
#include "collision/proximity/obstacle_trees.h"
#include "collision/proximity/proximity.h"
#include "demos/bake/bake_scene.h"
#include "demos/viewer/cloth_pull.h"
#include "demos/viewer/vertex_colours.h"
#include "demos/viewer/wind.h"
#include "gnn/stepper.h"

namespace cloth {

/// What the user wants at present. A copy can be handed to another thread.
struct ViewerControls {
    bool playing = true;
    int single_steps = 0;    ///< asked for so far; each is one step, playing or not
    int restarts = 0;        ///< asked for so far
    bool body_moves = true;  ///< false: the body holds its pose, and the cloth goes on
    std::string solver;      ///< see make_solver()
    Fabric fabric;
    WindSettings wind;
    ColourMode colours = ColourMode::garments;
    /// A hand at a vertex, and where it is (m).
    struct Pull {
        int vertex;
        Vec3 target;
    };
    std::optional<Pull> pull;
    PullSettings pull_settings;  ///< they count from the next grip on
};

bool operator==(const ViewerControls& a, const ViewerControls& b);

/// What is to be shown after a step.
struct ViewerFrame {
    int frame = 0;       ///< of the motion; below 0: the body is on its way to the first pose
    long steps = 0;      ///< since the start, or the last restart
    double time = 0.0;   ///< of the cloth, since its start (s)
    Points cloth;        ///< |V| x 3 (m)
    Points colours;      ///< |V| x 3, see vertex_colours(); empty: each garment has one colour
    Points skin;         ///< vertices of the body (m)
    std::string solver;  ///< that made the step
    StepReport report;   ///< of the last step
    double ms = 0.0;     ///< wall time of the last step
    StretchStatistics stretch;
    bool counts_tangles = false;  ///< StepReport::tangles is counted: the garments are layers
    bool is_pulled = false;
    std::string problem;  ///< what is wrong with the cloth, or empty
    std::string refusal;  ///< why a control was refused, or empty
};

/// A garment on a moving body that is stepped while the user plays with it. It knows of no window.
///
///     ViewerScene scene(options);
///     ViewerControls controls = scene.controls();
///     while (...) {
///         controls.solver = "xpbd-40";       // at any time
///         scene.advance(controls);
///         draw(scene.frame());
///     }
///
/// Neither a change of the controls nor a grip changes the state of the cloth: the next step goes
/// on from it. Equal controls in equal order give equal bits.
class ViewerScene {
 public:
    /// @param threads  of the engine; 0: all
    /// @throws UsageError, LoadError, ArgumentError if scene or solver cannot be had
    explicit ViewerScene(const SceneOptions& options, int threads = 0);
    ~ViewerScene();

    /// Those that it starts with.
    ViewerControls controls() const { return m_asked; }
    /// Takes over what has changed in the controls, and makes a step if they ask for one. A control
    /// that cannot be followed is refused, see ViewerFrame::refusal, and all stays as it was.
    /// @return  whether a step was made
    bool advance(const ViewerControls& controls);

    const ViewerFrame& frame() const { return m_frame; }
    const ClothState& state() const { return m_state; }
    const Garment& garment() const;  ///< of the fabric at present
    /// What is to be told of the files, a sentence each.
    const std::vector<std::string>& notes() const { return m_base.notes; }
    double frame_time() const { return m_base.cloth->frame_time(); }  ///< (s), of a step
    int frames() const { return m_base.cloth->frames(); }             ///< of the motion
    const Faces& body_faces() const { return m_base.body.faces; }
    const Faces& garment_faces() const { return m_base.cloth->garment().rest().faces; }
    /// Faces of each garment, numbered as all vertices are.
    const std::vector<Faces>& parts() const { return m_base.parts; }

 private:
    struct Worn;

    std::unique_ptr<Worn> wear(const std::string& solver, const Fabric& fabric,
                               const ClothPull* pull) const;
    void take(const ViewerControls& controls);
    void take_pull(const ViewerControls& controls);
    void use(const std::string& solver, const Fabric& fabric);
    void release();
    void restart();
    Boundary next_boundary(const ViewerControls& controls) const;
    void step(const ViewerControls& controls);
    void show(ColourMode colours);
    double motion_time(int frame) const { return frame * frame_time(); }

    BakeScene m_base;
    int m_threads;
    ViewerControls m_asked;                  ///< taken over, or refused
    std::string m_solver;                    ///< in use
    Fabric m_fabric;                         ///< in use
    WindSettings m_wind;                     ///< in use
    std::unique_ptr<Worn> m_free, m_pulled;  ///< without a pull; with one, or null
    std::optional<ClothPull> m_pull;
    ClothState m_state;
    std::shared_ptr<ObstacleTrees> m_trees;  ///< of the body: a new stepper need not build them
    Boundary m_boundary;                     ///< of the last step
    Proximity m_proximity;
    ViewerFrame m_frame;
};

}  // namespace cloth
