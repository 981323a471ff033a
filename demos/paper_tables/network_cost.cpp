#include "demos/paper_tables/network_cost.h"

#include <chrono>
#include <memory>
#include <utility>

#include "collision/proximity/proximity.h"
#include "demos/compare/statistics.h"
#include "gnn/model/engine.h"
#include "gnn/model/weights.h"
#include "gnn/physics/energy/incremental_potential.h"
#include "gnn/physics/stepper/guess.h"

namespace cloth {
namespace {

constexpr int rounds = 30;

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

/// A network that is ready to be evaluated.
struct Prepared {
    ClothGraph graph;
    Features features;
    std::unique_ptr<Engine> engine;
    std::vector<double> times;  ///< ms
};

Prepared prepare(const std::string& file, const ComparisonScene& scene, const ClothState& start,
                 int threads) {
    const Weights weights = Weights::load(file);
    ClothGraph graph = build_cloth_graph(scene.garment(), weights.config.graph_settings());
    Features features = features_at(scene, start, graph, weights.config.features);
    return {std::move(graph),
            std::move(features),
            std::make_unique<Engine>(weights, EngineSettings{threads}),
            {}};
}

}  // namespace

std::vector<NetworkCost> network_costs(const std::vector<std::string>& files,
                                       const ComparisonScene& scene, const ClothState& start,
                                       int threads) {
    std::vector<Prepared> networks;
    for (const std::string& file : files) networks.push_back(prepare(file, scene, start, threads));
    Points out;
    for (Prepared& network : networks)  // allocates
        network.engine->predict(network.graph, network.features, out);
    for (int round = 0; round < rounds; ++round)
        for (Prepared& network : networks) {
            const auto begin = std::chrono::steady_clock::now();
            network.engine->predict(network.graph, network.features, out);
            const auto time = std::chrono::steady_clock::now() - begin;
            network.times.push_back(std::chrono::duration<double, std::milli>(time).count());
        }
    std::vector<NetworkCost> costs;
    for (const Prepared& network : networks)
        costs.push_back(
            {1e-6 * static_cast<double>(network.engine->memory().total()), median(network.times)});
    return costs;
}

}  // namespace cloth
