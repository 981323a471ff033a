#pragma once

#include <string>

#include "gnn/graph/features.h"
#include "gnn/model/model_config.h"

namespace cloth {

/// Evaluates a trained network: LibTorch, or an engine without it.
class Predictor {
 public:
    virtual ~Predictor() = default;

    virtual const ModelConfig& config() const = 0;

    /// What solvers that use it are called.
    virtual std::string name() const { return config().variant; }

    /// Whether predict() may run while other independent predictors do, in other threads: what it
    /// changes is its own.
    virtual bool is_independent() const { return false; }

    /// One evaluation. The predicted position of vertex i is base_i + scale * out_i.
    /// @param graph  of the garment, built with config().graph_settings()
    /// @param out    |V| x 3: scaled accelerations; not finite if the evaluation failed, or if
    ///               graph or features are those of other settings
    virtual void predict(const ClothGraph& graph, const Features& features, Points& out) = 0;
};

}  // namespace cloth
