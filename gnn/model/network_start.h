#pragma once

#include <memory>
#include <string>

#include "gnn/model/predictor.h"
#include "gnn/physics/stepper/step_start.h"

namespace cloth {

/// A network says where a step starts: it is told the garment's state and the guess, and answers
/// with accelerations that are added to the guess.
class NetworkStart : public StepStart {
 public:
    /// Keeps a reference to `garment`. @throws ArgumentError if the predictor is null
    NetworkStart(const Garment& garment, std::shared_ptr<Predictor> predictor);

    /// The network's, such as "small".
    std::string name() const override { return m_predictor->name(); }
    double fixed_dt() const override { return m_predictor->config().dt; }
    /// If the predictor is, and nobody else holds it.
    bool is_independent() const override {
        return m_predictor.use_count() == 1 && m_predictor->is_independent();
    }
    bool predict(const ClothState& state, const Boundary& boundary,
                 const IncrementalPotential& potential, const Points& guess,
                 PotentialValue& at_guess, Points& prediction, StageTimes& times) override;

 private:
    std::shared_ptr<Predictor> m_predictor;
    ClothGraph m_graph;
    FeatureBuilder m_builder;
    Features m_features;
    Points m_output;  ///< |V| x 3: scaled accelerations
};

}  // namespace cloth
