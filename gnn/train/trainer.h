#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "gnn/train/network.h"
#include "gnn/train/optimizer.h"
#include "gnn/train/recipe.h"
#include "gnn/train/rollout_validation.h"
#include "gnn/train/scene_random.h"
#include "gnn/train/training_sums.h"
#include "gnn/train/training_worlds.h"
#include "gnn/train/validation.h"

namespace cloth {

struct TrainerSettings {
    ModelConfig model;
    Recipe recipe;
    SceneSettings scenes;
    ValidationSettings validation;
    RolloutSettings rollouts;    ///< of the validation; its `threads` are those here
    std::string device = "cpu";  ///< cpu or cuda
    int threads = 1;             ///< of LibTorch and of the validation, 1 to 256
    std::uint64_t seed = 1;
    std::int64_t iterations = 0;    ///< end of training, 0 to 1e9; 0: as many as fit into `minutes`
    double minutes = 0.0;           ///< wall time of training, 0 to 1e6; 0: no limit
    int pool = 40;                  ///< scenes trained on in turn, 1 to 1000
    int report_every = 100;         ///< iterations per row of metrics.csv, 1 to 1e6
    double validate_every = 10.0;   ///< minutes between validations, 0 to 1e4
    double validation_share = 0.1;  ///< of the time that they may take, 0 to 1; 0: none at all
    double save_every = 3.0;        ///< minutes between checkpoints, 0 to 1e4
    std::int64_t freeze_statistics = 1000;  ///< iterations that shape the feature statistics, 0 to
                                            ///< 1e9
    std::string start_weights;  ///< file of weights to start from; their feature statistics stay as
                                ///< they are. Empty: random ones
    std::string references;     ///< folder of the rollouts' references; empty: in `out`
    /// Folder of checkpoint.pt, weights.safetensors, metrics.csv and rollouts.csv
    std::string out = "out/train";
};

/// Trains a network on the incremental potential, without ground truth.
///
///     Trainer trainer(settings);
///     trainer.resume();  // if settings.out has a checkpoint
///     trainer.run(stop);
///
/// Two trainings of equal settings and a given number of iterations on one processor give equal
/// bits, whether or not one of them was stopped or killed and resumed, and whatever was validated
/// meanwhile. (Limited by `minutes` the learning rate follows the clock.)
///
/// metrics.csv has a row for each `report_every` iterations; where a validation has ended, it also
/// has single steps from unseen states (see Validation) and the means of rollouts (see
/// RolloutResult): SCENE_rollout_K_{frames,mm,stretch} with K iterations after the network.
/// rollouts.csv has each of them.
class Trainer {
 public:
    /// @throws ArgumentError for settings out of range, LoadError if `out` cannot be written
    explicit Trainer(TrainerSettings settings);
    ~Trainer();

    /// Goes on from the checkpoint in `out`. False: there is none.
    /// @throws LoadError if it is broken or of another configuration
    bool resume();

    /// Trains until the end or until `stop` is set; saves checkpoint and weights. Stopped, it does
    /// not validate any more.
    void run(const std::atomic<bool>& stop);

    /// One iteration; the loss of its last step.
    double iterate();

    void save();
    Weights weights() const { return m_network.export_weights(); }
    Network& network() { return m_network; }
    std::int64_t iteration() const { return m_iteration; }

 private:
    struct Run;
    struct Validated;

    double progress() const;
    bool is_done() const;
    double seconds_left() const;
    void fill_pool(const std::atomic<bool>& stop);
    void replace(size_t slot);
    void observe(const TrainingScene& scene);
    void add_noise(ClothState& state);
    bool train_on(TrainingScene& scene, Points& prediction, Points& target);
    bool move_on(TrainingScene& scene, const Points& prediction, const Points& target);
    void begin_sums();
    void kick_some(TrainingScene& scene);
    void report(bool validates);
    Validated validate();
    void write_row(const Validated& validated);
    void say(const Validated& validated) const;
    void load(torch::serialize::InputArchive& archive, const std::string& file);

    TrainerSettings m_settings;
    torch::Device m_device;
    Network m_network;
    Adam m_adam;
    SceneRandom m_random;
    SceneFactory m_factory;
    std::vector<std::unique_ptr<TrainingScene>> m_pool;
    std::unique_ptr<Validation> m_validation;
    std::unique_ptr<RolloutValidation> m_rollouts;
    StatisticsAccumulator m_node, m_edge, m_world, m_body;
    std::int64_t m_iteration = 0;
    double m_seconds = 0.0;  ///< trained so far
    LossValue m_loss;
    TrainingSums m_sums;
    std::unique_ptr<Run> m_run;
};

}  // namespace cloth
