// What a trainer looks up before it trains: the weights to start from, and what it will validate.

#include <filesystem>
#include <fstream>

#include "data/core/errors.h"
#include "gnn/train/setting_differences.h"
#include "gnn/train/trainer.h"
#include "gnn/train/validation_names.h"

namespace cloth {

/// The weights to start from. Late, because a training that goes on has weights of its own.
void Trainer::start() {
    if (m_started) return;
    if (!m_settings.start_weights.empty()) {
        Weights start = Weights::load(m_settings.start_weights);
        start.config.dt = m_settings.model.dt;  // features and answers are in units of g dt^2
        if (!(start.config == m_settings.model))
            throw ArgumentError(
                "--weights " + m_settings.start_weights,
                "is of another network: " +
                    to_text(differences(start.config, m_settings.model), "asked for"),
                "give the options of its network: " + options_of(start.config));
        m_network.import_weights(start);
        if (m_mean.defined()) m_mean.copy_(m_network.parameters().flat().detach());
    }
    m_started = true;
}

/// Whether a file can be made in the folder, which is made for it.
static void check_writable(const std::string& folder, const std::string& option) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    const std::string file = folder + "/writable.tmp";
    const bool is_written = static_cast<bool>(std::ofstream(file) << "1\n");
    std::filesystem::remove(file, error);
    if (!is_written)
        throw LoadError(option + " " + folder, "", "cannot be written",
                        "check the folder and its permissions, or give another");
}

/// What is misspelt must not end the training at its first validation.
void Trainer::look_up_validation() {
    if (m_factory.has_garments() && m_settings.validation.garment_states > 0)
        for (const std::string& clip : validation_clips())
            m_factory.make_garment(1, clip, m_settings.validation.garment);
    m_rollouts =
        std::make_unique<RolloutValidation>(m_factory, m_settings.rollouts, m_settings.references);
    check_writable(m_settings.references, "--references");
}

}  // namespace cloth
