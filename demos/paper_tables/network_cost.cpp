#include "demos/paper_tables/network_cost.h"

#include <chrono>

#include "collision/proximity/proximity.h"
#include "demos/compare/statistics.h"
#include "gnn/model/engine.h"
#include "gnn/model/weights.h"
#include "gnn/physics/energy/incremental_potential.h"
#include "gnn/physics/stepper/guess.h"

namespace cloth {
namespace {

constexpr int evaluations = 15;

Features features_at(const ComparisonScene& scene, const ClothState& start, const ClothGraph& graph,
                     const FeatureSettings& settings) {
    const Garment& garment = scene.garment();
    const Boundary boundary = scene.frame_boundary(0);
    SurfaceContacts contacts;
    Proximity().query(start.x, boundary, contacts);
    IncrementalPotential potential(garment);
    potential.begin_step(start, boundary, contacts, scene.frame_time());
    Points base;
    starting_guess(garment, start, boundary, contacts, scene.frame_time(),
                   potential.settings().contact_distance, base);
    Features features;
    FeatureBuilder(garment, graph, settings).build(start, boundary, potential, base, features);
    return features;
}

}  // namespace

NetworkCost network_cost(const std::string& file, const ComparisonScene& scene,
                         const ClothState& start, int threads) {
    const Weights weights = Weights::load(file);
    const ClothGraph graph = build_cloth_graph(scene.garment(), weights.config.graph_settings());
    const Features features = features_at(scene, start, graph, weights.config.features);
    Engine engine(weights, EngineSettings{threads});
    Points out;
    engine.predict(graph, features, out);  // allocates
    std::vector<double> times;
    for (int k = 0; k < evaluations; ++k) {
        const auto begin = std::chrono::steady_clock::now();
        engine.predict(graph, features, out);
        const auto time = std::chrono::steady_clock::now() - begin;
        times.push_back(std::chrono::duration<double, std::milli>(time).count());
    }
    return {1e-6 * static_cast<double>(engine.memory().total()), median(times)};
}

}  // namespace cloth
