#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "collision/proximity/proximity.h"
#include "demos/hard_cases/hard_cases.h"
#include "gnn/stepper.h"

namespace cloth {

/// What a solver made of a case.
struct HardRun {
    int frames = 0;  ///< that it lasted
    bool finite = true;
    std::optional<int> first_failed_frame;           ///< the first one out of bounds
    std::string failure;                             ///< in what way
    std::vector<double> ms, stretch_p99, rms_speed;  ///< one per frame
    std::vector<double> penetration_mm;              ///< deepest free vertex
    std::vector<int> tangles;        ///< edges through faces, if the case has a bound on them
    std::vector<double> surface_mm;  ///< deepest point, edge midpoints and face centres included
    std::optional<double> rest_jitter_mm;  ///< of a case that ran in full
    std::vector<Points> x;  ///< the garment at the frames asked for, as far as it got

    bool held() const { return !first_failed_frame; }
};

/// The frames that are drawn, of a run of so many: first, middle, last.
std::vector<int> picture_frames(int frames);

/// Why a stepper cannot be asked to run a scene; empty: it can.
std::string not_applicable(const Stepper& stepper, const HardScene& scene);

/// Runs scene.frames() frames from the scene's start, each held against the bounds. What happens
/// late (Bounds::end_stretch_p99, rest_jitter_mm) is looked at only if the case runs in full.
///
/// A stepper with a time step of its own takes as many of its steps per frame as make a frame of
/// the case, as a Bullet world would let it.
/// @param frames  at which the garment is kept, such as picture_frames()
/// @param done    called after every frame
/// @param start   see HardScene::start_from()
HardRun run_hard_case(const HardCase& hard, const HardScene& scene, Stepper& stepper,
                      const std::vector<int>& frames, const std::function<void(int)>& done,
                      int start = 0);

/// The axis of a capsule that crosses a face: cloth that a limb has passed through. Vertices alone
/// do not show it.
bool is_impaled(const Boundary& boundary, const Faces& faces, const Points& x);

}  // namespace cloth
