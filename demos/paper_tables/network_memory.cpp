#include "demos/paper_tables/network_memory.h"

#include "collision/proximity/proximity.h"
#include "gnn/model/engine.h"
#include "gnn/model/weights.h"
#include "gnn/physics/energy/incremental_potential.h"
#include "gnn/physics/stepper/guess.h"

namespace cloth {

double network_memory_mb(const std::string& file, const ComparisonScene& scene,
                         const ClothState& start) {
    const Weights weights = Weights::load(file);
    const ModelConfig& config = weights.config;
    const Garment& garment = scene.garment();
    const Boundary boundary = scene.frame_boundary(0);
    SurfaceContacts contacts;
    Proximity().query(start.x, boundary, contacts);
    IncrementalPotential potential(garment);
    potential.begin_step(start, boundary, contacts, scene.frame_time());
    Points base, out;
    starting_guess(garment, start, boundary, contacts, scene.frame_time(),
                   potential.settings().contact_distance, base);
    const ClothGraph graph = build_cloth_graph(garment, config.graph_settings());
    Features features;
    FeatureBuilder(garment, graph, config.features)
        .build(start, boundary, potential, base, features);
    Engine engine(weights, EngineSettings{1});
    engine.predict(graph, features, out);
    return 1e-6 * static_cast<double>(engine.memory().total());
}

}  // namespace cloth
