#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "demos/compare/body_scene.h"
#include "demos/compare/lasting_loss.h"
#include "gnn/stepper.h"
#include "render/scene.h"

namespace cloth {

/// One outfit on one body, stepped through a motion, and what is seen of it.
///
///     Look look({"dress", "soft", "heavy"}, "small", 0);
///     look.settle();
///     while (look.frame() < look.frames()) look.step();
class Look {
 public:
    /// @param solver  as make_solver() takes it
    /// @param threads  of the engine; 0: all
    /// @throws UsageError, LoadError, ArgumentError
    Look(const BodySceneSettings& settings, const std::string& solver, int threads);

    const BodyScene& scene() const { return m_scene; }
    int frames() const { return m_scene.frames(); }
    int frame() const { return m_frame; }  ///< that comes next

    /// The lead-in, in which the body moves into the motion's first pose.
    void settle();
    void step();

    /// Body and garments as they are now, each garment in a colour of its own. @param colour  first
    Scene picture(size_t colour) const;
    Points skin() const { return m_scene.skin(frame() * m_scene.frame_time()); }  ///< |V| x 3 (m)

    /// Why it cannot be shown: torn, or not on the body any more; empty: it can.
    const std::string& failure() const { return m_failure; }
    nlohmann::ordered_json measured() const;

 private:
    void measure(const StepReport& report);
    void fail(int frame, const std::string& how);

    BodyScene m_scene;
    std::string m_garment, m_body, m_motion;
    std::unique_ptr<Stepper> m_stepper;
    ClothState m_state;
    std::vector<std::shared_ptr<const Faces>> m_faces;  ///< of each garment
    int m_frame = 0;
    double m_stretch_p99 = 0.0, m_stretch_max = 0.0, m_depth = 0.0;  ///< largest so far; (m)
    int m_failed_steps = 0;
    LastingLoss m_loss;
    std::string m_failure;
};

}  // namespace cloth
