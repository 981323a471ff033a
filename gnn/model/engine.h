#pragma once

#include <memory>

#include "gnn/model/engine_weights.h"
#include "gnn/model/predictor.h"

namespace cloth {

struct EngineSettings {
    int threads = 0;  ///< 0 to 1024; 0: as many as OpenMP gives; results do not depend on it
    Instructions instructions = best_instructions();
};

/// Resident bytes of an engine by part.
struct EngineMemory {
    size_t weights = 0;    ///< shared by engines of the same EngineWeights
    size_t topology = 0;   ///< tables of the garment
    size_t workspace = 0;  ///< latents and scratch
    size_t total() const { return weights + topology + workspace; }
};

/// Runs trained weights without LibTorch: fused message blocks over groups of neighbouring
/// vertices, one barrier per message step, no allocation once the garment is known.
///
///     const auto weights = std::make_shared<const EngineWeights>(Weights::load(file));
///     const auto stepper = make_cloth(garment, std::make_shared<Engine>(weights));
///
/// One engine serves one thread at a time; several share their weights.
class Engine : public Predictor {
 public:
    /// @throws ArgumentError if this processor lacks the instructions or threads is out of range
    explicit Engine(std::shared_ptr<const EngineWeights> weights, EngineSettings settings = {});
    /// Weights of its own. @throws ArgumentError as EngineWeights does
    explicit Engine(const Weights& weights, EngineSettings settings = {});
    ~Engine() override;

    const ModelConfig& config() const override;
    std::string name() const override { return m_weights->name(); }
    bool is_independent() const override { return true; }
    void predict(const ClothGraph& graph, const Features& features, Points& out) override;

    EngineMemory memory() const;

 private:
    struct Topology;
    struct Workspace;
    class Pass;

    void prepare(const ClothGraph& graph);

    std::shared_ptr<const EngineWeights> m_weights;
    EngineSettings m_settings;
    std::unique_ptr<Topology> m_topology;
    std::unique_ptr<Workspace> m_workspace;
};

}  // namespace cloth
