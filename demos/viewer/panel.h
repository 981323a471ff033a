#pragma once

#include <optional>
#include <string>
#include <vector>

#include "demos/viewer/solver_choice.h"
#include "demos/viewer/viewer_scene.h"

namespace cloth {

/// The panel at the left of the window. It changes controls, and tells what the last step did.
class Panel {
 public:
    static constexpr float width = 310.0f;  ///< (pixels)

    /// What is shown how; the simulation does not know.
    struct View {
        bool wireframe = false, shadows = true, follow = true, body = true;
        bool reset_camera = false;  ///< asked for in this picture
    };

    Panel(const SceneOptions& scene, const ViewerControls& start);

    View view;
    /// The user wants another garment, body or motion; whoever makes that scene takes it away.
    std::optional<SceneOptions> wanted;
    std::string scene_state;  ///< that it is being made, or why it cannot be; or empty

    /// To be called once in each picture. @param frames  of the motion
    void draw(ViewerControls& controls, const ViewerFrame& frame, int frames);
    /// The next step's time for the graph (ms).
    void add_time(double ms);
    void clear_times() { m_times.clear(); }

 private:
    void draw_scene();
    void draw_playback(ViewerControls& controls, const ViewerFrame& frame, int frames);
    void draw_solver(ViewerControls& controls, const ViewerFrame& frame);
    void draw_fabric(ViewerControls& controls);
    void draw_world(ViewerControls& controls);
    void draw_view(ViewerControls& controls);
    void draw_report(const ViewerFrame& frame) const;

    SceneOptions m_scene;  ///< as the lists stand
    std::vector<std::string> m_garments, m_bodies, m_motions, m_kinds;
    SolverChoice m_choice;
    Fabric m_fabric;  ///< as the sliders stand; it is worn when the mouse lets go
    std::vector<float> m_times;
};

}  // namespace cloth
