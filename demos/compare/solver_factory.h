#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "demos/compare/comparison_scene.h"
#include "gnn/model/predictor.h"
#include "gnn/model/weights.h"
#include "gnn/stepper.h"

namespace cloth {

struct StepSettings;

/// Evaluates trained weights with LibTorch.
using TorchMaker = std::function<std::shared_ptr<Predictor>(const Weights&)>;

struct SolverSettings {
    std::string weights;         ///< folder of trained weights; empty: the committed ones
    int threads = 0;             ///< of the engine; 0: all that OpenMP gives
    TorchMaker torch = nullptr;  ///< empty: LibTorch is not built in
};

/// Of prefix + "KsR", R small steps a second of K iterations each; none: another name.
/// @throws UsageError for a number out of range
std::optional<StepSettings> small_steps_named(const std::string& solver,
                                              const std::string& prefix = "quasi-newton-");

/// Makes the solver called `name` for the scene's garment:
///
/// | name               | is                                                            |
/// |--------------------|---------------------------------------------------------------|
/// | default            | the library's: ClothStepper with default settings             |
/// | bullet             | Bullet's own, 10 iterations, 2 sub-steps per frame            |
/// | bullet-fine        | 5 iterations, 8 sub-steps                                     |
/// | bullet-K           | K iterations, 2 sub-steps                                     |
/// | bullet-KxS         | K iterations, S sub-steps                                     |
/// | reference          | Newton's method, converged                                    |
/// | newton-K           | K iterations of it                                            |
/// | quasi-newton       | whole quasi-Newton steps with error control, guarded          |
/// | quasi-newton-KsR   | R small steps a second, K iterations each, guarded; 3s120 is  |
/// |                    | the default of soft cloth                                     |
/// | quasi-newton-KsR-cgN | the same by Newton's method, N conjugate gradients each;    |
/// |                    | 1s120-cg10 is the default of stiff cloth                      |
/// | quasi-newton-K     | K quasi-Newton iterations                                     |
/// | quasi-newton-KxS   | the same in S sub-steps                                       |
/// | xpbd-N             | springs relaxed in N sub-steps                                |
/// | VARIANT            | the network VARIANT.safetensors with error control, guarded   |
/// | VARIANT+K          | the network and exactly K quasi-Newton iterations             |
/// | VARIANT+KsR        | the network and such small steps, guarded                     |
/// | torch-VARIANT[+K]  | the same, run by LibTorch instead of the engine               |
/// | bf16-VARIANT[+K]   | the same, in the engine with products in bfloat16             |
///
/// | skinning           | the garment's own network, skinning/GARMENT.safetensors in the|
/// |                    | folder of weights, projected out of obstacles                 |
/// | skinning-raw       | the same as it answers, see SkinningStepper                   |
///
/// All but Bullet's, XPBD and skinning take "-bdf2" at the end: the same with BDF2 instead of
/// backward Euler. They also take "@M": the same in M ms a step, see Stepper::set_max_ms().
///
/// "SOLVER~N" simulates a proxy of about N vertices by SOLVER, and shows the garment following it;
/// "SOLVER~GARMENT" another garment of the same cut, such as tshirt_1000: see make_proxy_solver().
/// Behind that, "+K", "+NETWORK" or "+NETWORK+K" give the garment a step of its own from there: K
/// quasi-Newton iterations, a network, or both.
///
/// @throws UsageError for an unknown name, a number out of range or a garment without a skinning
///         network, LoadError for broken weights, ArgumentError if the garment can have no such
///         proxy
std::unique_ptr<Stepper> make_solver(const std::string& name, const ComparisonScene& scene,
                                     const SolverSettings& settings);

/// What the name of a network says: [torch-|bf16-]VARIANT[+K[sR]].
struct NetworkName {
    explicit NetworkName(const std::string& name);
    bool torch, bfloat16;
    std::string variant;
    std::string refine;  ///< K or KsR as it was written
    bool as_shipped;     ///< no +
};

/// The networks whose weights lie in the folder (empty: the committed ones), in alphabetical order;
/// those for the detail of proxies, whose names end in "_detail", are left out.
std::vector<std::string> networks_in(const std::string& folder);

/// The file of a network's weights. @throws UsageError naming the networks there are
std::string weights_file(const std::string& variant, const std::string& folder);

}  // namespace cloth
