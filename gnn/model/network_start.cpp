#include "gnn/model/network_start.h"

#include <limits>
#include <utility>

#include "data/core/errors.h"
#include "gnn/physics/stepper/stopwatch.h"

namespace cloth {
namespace {

std::shared_ptr<Predictor> checked(std::shared_ptr<Predictor> predictor) {
    if (!predictor)
        throw ArgumentError("predictor", "is null", "pass an Engine made of trained weights");
    return predictor;
}

}  // namespace

NetworkStart::NetworkStart(const Garment& garment, std::shared_ptr<Predictor> predictor)
    : m_predictor(checked(std::move(predictor))),
      m_graph(build_cloth_graph(garment, m_predictor->config().graph_settings())),
      m_builder(garment, m_graph, m_predictor->config().features) {
}

bool NetworkStart::predict(const ClothState& state, const Boundary& boundary,
                           const IncrementalPotential& potential, const Points& guess,
                           PotentialValue& at_guess, Points& prediction, StageTimes& times) {
    Stopwatch watch;
    const bool guess_known =
        m_builder.build(state, boundary, potential, guess, m_features, &at_guess);
    times.features += watch.lap();
    m_predictor->predict(m_graph, m_features, m_output);
    if (m_output.rows() == guess.rows())
        prediction = guess + m_features.scale * m_output;
    else
        prediction.setConstant(guess.rows(), 3, std::numeric_limits<double>::quiet_NaN());
    times.solve += watch.lap();
    return guess_known;
}

}  // namespace cloth
