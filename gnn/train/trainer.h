#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gnn/train/network.h"
#include "gnn/train/optimizer.h"
#include "gnn/train/process_group.h"
#include "gnn/train/recipe.h"
#include "gnn/train/rollout_validation.h"
#include "gnn/train/scene_pool.h"
#include "gnn/train/scene_statistics.h"
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
    int threads = 1;             ///< for the scenes of a batch and for the validation, 1 to 256
    std::uint64_t seed = 1;
    std::int64_t iterations = 0;  ///< end of training, 0 to 1e9; 0: as many as fit into `minutes`
    double minutes = 0.0;         ///< wall time of training, 0 to 1e6; 0: no limit
    int batch = 1;  ///< scenes of an iteration, whose mean gradient is followed: 1 to 4096, a
                    ///< multiple of the number of processes
    /// The scenes of a batch pass the network at once, as they always do on a GPU: the same but for
    /// rounding.
    bool at_once = false;
    int pool = 40;                  ///< scenes trained on in turn, for each of the batch, 1 to 1000
    int report_every = 100;         ///< iterations per row of metrics.csv, 1 to 1e6
    double validate_every = 10.0;   ///< minutes between validations, 0 to 1e4
    double validation_share = 0.1;  ///< of the time that they may take, 0 to 1; 0: none at all
    double save_every = 3.0;        ///< minutes between checkpoints, 0 to 1e4
    std::int64_t freeze_statistics = 1000;  ///< iterations that shape the feature statistics, 0 to
                                            ///< 1e9
    std::string start_weights;  ///< file of weights to start from, of any time step; their feature
                                ///< statistics stay as they are. Read when the training starts, not
                                ///< when it is resumed. Empty: random ones
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
/// Several processes share the scenes of the batch, on one machine or many; each has a trainer of
/// the same settings. The first one writes all files, also the scenes of the others: a training may
/// be resumed by another number of processes. Results depend on that number by rounding only.
///
/// metrics.csv has a row for each `report_every` iterations, of the first process's scenes; where a
/// validation has ended, it also has single steps from unseen states (see Validation) and the means
/// of rollouts (see RolloutResult): SCENE_rollout_K_{frames,mm,stretch} with K iterations after the
/// network. rollouts.csv has each of them.
class Trainer {
 public:
    /// @param group  the processes that train; one alone by default
    /// What will be validated is looked up now: clips, garments and the folder of the references.
    /// @throws ArgumentError for settings out of range, LoadError if `out` or the references cannot
    ///         be written, or garments or motions cannot be loaded
    explicit Trainer(TrainerSettings settings, ProcessGroup group = {});
    ~Trainer();

    /// Goes on from the checkpoint in `out`. False: there is none.
    /// @throws LoadError if it is broken or of other settings, naming those that differ
    bool resume();

    /// Trains until the end or until `stop` is set; saves checkpoint and weights. Stopped, it does
    /// not validate any more. Of several processes all stop if one is to.
    /// @throws ProcessGroupError if another process has ended; LoadError or ArgumentError, before
    ///         the first iteration, if the weights to start from cannot be used
    void run(const std::atomic<bool>& stop);

    /// One iteration; the mean loss of its last step over the scenes of this process.
    double iterate();

    void save();
    /// The network as it is saved: Recipe::mean_share.
    Weights weights();
    Network& network() {
        start();
        return m_network;
    }
    std::int64_t iteration() const { return m_iteration; }

 private:
    struct Run;
    struct Validated;
    class WithMean;

    /// One scene of the batch: those it is drawn from, and what an iteration knows of it.
    struct Lane {
        Lane(int index, const SceneFactory& factory, const TrainerSettings& settings);

        int number;  ///< in the batch
        ScenePool pool;
        TrainingScene* scene = nullptr;
        ClothState kept;  ///< the scene's, before noise
        int kept_age = 0;
        Points prediction, target;
        LossValue loss;
        EnergyTerms terms;
        bool sound = true, has_terms = false, kicked = false;
    };

    void start();
    void look_up_validation();
    double progress() const;
    bool is_done() const;
    double seconds_left() const;
    double iterations_per_second() const;
    bool is_filled() const;
    void fill_pools(const std::atomic<bool>& stop);
    void begin(Lane& lane);
    void share_statistics();
    bool judge(Lane& lane);
    torch::Tensor seed_of(const Lane& lane) const;
    bool differentiate(Lane& lane);
    void differentiate_at_once();
    void add_gradient(int lanes);
    void step_together();
    void add_to_mean();
    bool move_on(Lane& lane);
    void end(Lane& lane);
    void count(const Lane& lane);
    void begin_sums();
    bool kick_some(Lane& lane);
    void for_each_lane(double TrainingSums::*seconds, const std::function<void(Lane&)>& work);
    void report(bool validates);
    Validated validate();
    void write_row(const Validated& validated);
    void say(const Validated& validated) const;
    void load(torch::serialize::InputArchive& archive, const std::string& file);
    void check_settings(torch::serialize::InputArchive& archive, const std::string& file) const;
    void write_scenes(torch::serialize::OutputArchive& archive) const;

    TrainerSettings m_settings;
    ProcessGroup m_group;
    torch::Device m_device;
    Network m_network;
    Adam m_adam;
    torch::Tensor m_mean;  ///< of the parameters, if the recipe has one
    torch::Tensor m_sum;   ///< of gradients, and how many there are
    SceneFactory m_factory;
    std::vector<Lane> m_lanes;
    std::unique_ptr<Validation> m_validation;
    std::unique_ptr<RolloutValidation> m_rollouts;
    SceneStatistics m_own_statistics, m_statistics;  ///< of this process, of all
    bool m_started = false;  ///< start_weights are in the network, or what a checkpoint has
    std::int64_t m_iteration = 0;
    double m_seconds = 0.0;  ///< trained so far, by the clock of the first process
    TrainingSums m_sums;
    std::unique_ptr<Run> m_run;  ///< of the first process
};

}  // namespace cloth
