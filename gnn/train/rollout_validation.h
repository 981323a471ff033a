#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gnn/model/weights.h"
#include "gnn/stepper.h"
#include "gnn/train/training_worlds.h"

namespace cloth {

class EngineWeights;

/// What a network is asked to simulate while it is trained.
struct RolloutSettings {
    /// Motions, as load_motion_by_name() takes them; empty: those of the shared data folder's
    /// motions/validation, else 01_01.
    std::vector<std::string> clips;
    /// Each is dressed on each clip: names of garments that the factory has. Empty: tshirt,
    /// pants_1000 and dress_1000, or those of them that it has, or else its last one.
    std::vector<std::string> garments;
    int sheet_vertices = 1000;  ///< of the hanging sheet and of that on a sphere, 9 to 200,000; 0:
                                ///< no sheets
    int frames = 90;            ///< after the lead-in, 1 to 10,000
    std::vector<int> iterations = {0, 3, 5};  ///< quasi-Newton iterations after the network, 0 to
                                              ///< 100 each; one rollout for each
    int reference_iterations = 60;  ///< of Newton's method in a step of the reference at most, 1 to
                                    ///< 1000
    int threads = 1;                ///< of network and nearest points, 1 to 256

    /// @throws ArgumentError if a value is out of its range
    void check() const;
};

/// One rollout. A garment is lost where it is on average (RMS over the vertices) farther from the
/// reference than `lost_distance`, and torn where 1 % of its edges are longer than twice their rest
/// length; the rollout ends there.
struct RolloutResult {
    static constexpr double lost_distance = 0.3;  ///< (m)

    /// The motion, by the name of its file, or by its path if another has that name;
    /// "sheet-hanging" or "sheet-sphere".
    std::string scene;
    std::string garment;  ///< empty: a sheet
    bool is_sheet() const { return garment.empty(); }
    int iterations = 0;   ///< after the network
    int frames = 0;       ///< of the scene
    int held = 0;         ///< frames before the failure
    std::string failure;  ///< "not finite", "torn" or "lost"; empty: it held
    /// RMS distance to the reference, mean over all frames of the scene (m); frames that were not
    /// held count as lost_distance, so that a network that fails early does not look good.
    double distance = 0.0;
    double stretch = 0.0;      ///< highest 99th percentile of length over rest length
    double penetration = 0.0;  ///< deepest point inside an obstacle after a step (m)
};

/// Rollouts of a network in the stepper that ships: engine, contact projection, limbs that pass
/// through each other. Steps are never cut into sub-steps of the solver, which would hide what the
/// network does. Garments that follow a proxy do so here, too (see make_proxy_cloth()).
///
/// The reference minimises the same energy at the same time step by Newton's method. It is computed
/// when it is first needed, which takes minutes, and kept in a folder for the next run.
class RolloutValidation {
 public:
    /// @param folder  of the references
    /// @throws ArgumentError if a setting is out of range or the factory has no garment of a name,
    ///         LoadError for a motion that is not there
    RolloutValidation(const SceneFactory& factory, const RolloutSettings& settings,
                      const std::string& folder);
    ~RolloutValidation();

    /// Computes or reads the references. False: `stop` was set meanwhile.
    bool prepare(const std::atomic<bool>& stop);

    /// All scenes with each number of iterations, in that order. Nothing: `stop` was set meanwhile.
    std::optional<std::vector<RolloutResult>> measure(const Weights& weights,
                                                      const std::atomic<bool>& stop);

 private:
    struct Scene;
    void add_garments(const SceneFactory& factory);
    bool find_reference(Scene& scene, const std::atomic<bool>& stop) const;
    std::unique_ptr<Stepper> make_stepper(const Scene& scene,
                                          const std::shared_ptr<const EngineWeights>& weights,
                                          int iterations) const;
    bool roll(const Scene& scene, Stepper& stepper, RolloutResult& result,
              const std::atomic<bool>& stop) const;

    RolloutSettings m_settings;
    std::string m_folder;
    std::vector<std::unique_ptr<Scene>> m_scenes;
};

/// Means over the garments, or the sheets, with one number of iterations; NaN without any.
struct RolloutSummary {
    double held = 0.0, distance_mm = 0.0, stretch = 0.0;
};
RolloutSummary summarise(const std::vector<RolloutResult>& results, bool sheets, int iterations);

}  // namespace cloth
