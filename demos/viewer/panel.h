#pragma once

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

    explicit Panel(const ViewerControls& start);

    View view;

    /// To be called once in each picture. @param frames  of the motion
    void draw(ViewerControls& controls, const ViewerFrame& frame, int frames);
    /// The next step's time for the graph (ms).
    void add_time(double ms);

 private:
    void draw_playback(ViewerControls& controls, const ViewerFrame& frame, int frames);
    void draw_solver(ViewerControls& controls, const ViewerFrame& frame);
    void draw_fabric(ViewerControls& controls);
    void draw_world(ViewerControls& controls);
    void draw_view(ViewerControls& controls);
    void draw_report(const ViewerFrame& frame) const;

    std::vector<std::string> m_kinds;
    SolverChoice m_choice;
    Fabric m_fabric;  ///< as the sliders stand; it is worn when the mouse lets go
    std::vector<float> m_times;
};

}  // namespace cloth
