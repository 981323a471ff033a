#pragma once

#include <memory>

#include "gnn/model/predictor.h"
#include "gnn/model/weights.h"

namespace cloth {

struct EngineSettings {
    int threads = 0;  ///< 0: as many as OpenMP gives; results do not depend on it
};

/// Resident bytes of an engine by part.
struct EngineMemory {
    size_t weights = 0;    ///< shared by engines of the same weights
    size_t topology = 0;   ///< tables of the garment
    size_t workspace = 0;  ///< latents and scratch
};

/// Runs trained weights without LibTorch: fused message blocks over groups of neighbouring
/// vertices, two barriers a frame and one per message step, no allocation once the garment is
/// known.
///
///     auto weights = std::make_shared<const Weights>(Weights::load(file));
///     LearnedStepper stepper(garment, std::make_shared<Engine>(weights));
///
/// One engine serves one thread at a time; several share their weights.
class Engine : public Predictor {
 public:
    /// @throws ArgumentError if the width is no multiple of 16 or there are not two hidden layers
    explicit Engine(std::shared_ptr<const Weights> weights, EngineSettings settings = {});
    ~Engine() override;

    const ModelConfig& config() const override;
    void predict(const ClothGraph& graph, const Features& features, Points& out) override;

    EngineMemory memory() const;

 private:
    struct Implementation;
    std::unique_ptr<Implementation> m_implementation;
};

}  // namespace cloth
