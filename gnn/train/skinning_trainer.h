#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "gnn/skinning/skinning_weights.h"
#include "gnn/train/optimizer.h"
#include "gnn/train/parameters.h"
#include "gnn/train/skinning_clips.h"
#include "gnn/train/skinning_loss.h"

namespace cloth {

struct SkinningTrainerSettings {
    std::string garment = "tshirt_1000";  ///< as load_garment() takes it
    std::vector<std::string> motions;     ///< names or files; empty: training_motions()
    std::string validation_motion = "01_01";
    SkinningConfig model;                            ///< ages, layers, scale and dt
    LossKind loss = LossKind::log;                   ///< energy or log
    int sequences = 4;                               ///< of an iteration, 1 to 64
    int frames = 4;                                  ///< of a sequence, in a row, 1 to 64
    double learning_rate = 1e-3;                     ///< 1e-7 to 0.1; cosine decay to 2 %
    double contact_first = 5e4, contact_last = 5e5;  ///< contact weight (N/m^2), 1e3 to 1e6, grows
                                                     ///< in the first half
    std::int64_t iterations = 0;  ///< end of training, 0 to 1e9; 0: as many as fit into `minutes`
    double minutes = 0.0;         ///< wall time of training, 0 to 1e6; 0: no limit
    std::uint64_t seed = 1;
    int threads = 1;                   ///< of LibTorch, 1 to 256
    int report_every = 50;             ///< iterations per row of metrics.csv, 1 to 1e6
    int validate_every = 500;          ///< iterations between validations, 0 to 1e6; 0: none
    double save_every = 3.0;           ///< minutes between checkpoints, 0 to 1e4
    std::string out = "out/skinning";  ///< folder of checkpoint.pt, weights.safetensors and
                                       ///< metrics.csv
};

/// What a skinning network does with a motion that it was not trained on.
struct SkinningValidation {
    double energy = 0.0;   ///< mean of the incremental potential (J)
    EnergyTerms terms;     ///< its parts
    double stretch = 0.0;  ///< highest 99th percentile of length over rest length
    double inside = 0.0;   ///< mean part of the vertices deeper than 1 mm inside the body
};

/// Trains a garment-specific skinning network without ground truth, on the energy that all solvers
/// here minimise. A sequence is answered frame by frame; the loss of a frame is the incremental
/// potential of its step from the answers to the two frames before, through which no gradient goes
/// (as SNUG and its successors have it).
///
///     SkinningTrainer trainer(settings);
///     trainer.resume();  // if settings.out has a checkpoint
///     trainer.run(stop);
///
/// Two trainings of equal settings and a given number of iterations give equal bits, whether or not
/// one of them was stopped and resumed.
class SkinningTrainer {
 public:
    /// @throws ArgumentError for settings out of range, LoadError if garment or motions cannot be
    ///         loaded or `out` cannot be written
    explicit SkinningTrainer(SkinningTrainerSettings settings);

    /// Goes on from the checkpoint in `out`. False: there is none.
    /// @throws LoadError if it is broken or of other settings
    bool resume();

    /// Trains until the end or until `stop` is set; saves checkpoint and weights.
    void run(const std::atomic<bool>& stop);

    /// One iteration; the mean loss of its frames.
    double iterate();

    void save();
    SkinningWeights weights() const;
    std::int64_t iteration() const { return m_iteration; }
    SkinningValidation validate();

    /// Displacements (|V| x 3, m) for each of the features, by LibTorch.
    std::vector<Points> displacements(const std::vector<VectorX>& features);

 private:
    torch::Tensor forward(const std::vector<VectorX>& features) const;
    void pose(const SkinningWindow& window, const float* outputs, std::vector<Points>& x) const;
    double learn_window(const SkinningWindow& window, const float* outputs, float* gradient);
    double progress() const;
    bool is_done() const;
    void write_row(const SkinningValidation* validation);
    void load(torch::serialize::InputArchive& archive, const std::string& file);

    SkinningTrainerSettings m_settings;
    std::shared_ptr<const Body> m_body;
    std::unique_ptr<Garment> m_garment;
    SkinningWeights m_weights;  ///< but for the layers
    SkinWeights m_skin;
    Points m_worn;
    Parameters m_parameters;
    Adam m_adam;
    SceneRandom m_random;
    std::unique_ptr<SkinningClips> m_clips, m_validation;
    SkinningLoss m_loss;
    Proximity m_proximity;
    VectorX m_mean, m_deviation;
    std::int64_t m_iteration = 0;
    double m_seconds = 0.0;  ///< trained so far
    EnergyTerms m_sum;       ///< of the frames since the last row
    double m_loss_sum = 0.0;
    int m_losses = 0;  ///< in m_loss_sum
    int m_summed = 0;
};

}  // namespace cloth
