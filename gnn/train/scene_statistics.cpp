#include "gnn/train/scene_statistics.h"

#include "gnn/train/archive_tensors.h"

namespace cloth {

SceneStatistics::SceneStatistics(const ModelConfig& config)
    : m_node(node_layout(config.features.force_features)),
      m_edge(edge_layout()),
      m_world(world_layout()),
      m_body(body_layout()) {
}

void SceneStatistics::add(const Features& features) {
    m_node.add(features.node);
    m_edge.add(features.edge);
    m_world.add(features.world, &features.world_mask);
    m_body.add(features.body, &features.world_mask);
}

void SceneStatistics::sum(const ProcessGroup& group) {
    each(*this, [&](const char*, StatisticsAccumulator& part) {
        torch::Tensor state = to_tensor(part.state());
        group.sum(state);
        part.set_state(to_vector(state));
    });
}

void SceneStatistics::clear() {
    each(*this, [](const char*, StatisticsAccumulator& part) {
        part.set_state(Eigen::VectorXd::Zero(part.state().size()));
    });
}

NetworkStatistics SceneStatistics::statistics() const {
    return {m_node.statistics(), m_edge.statistics(), m_world.statistics(), m_body.statistics()};
}

void SceneStatistics::write(torch::serialize::OutputArchive& archive) const {
    each(*this, [&](const char* name, const StatisticsAccumulator& part) {
        archive.write(std::string("statistics.") + name, to_tensor(part.state()));
    });
}

void SceneStatistics::read(torch::serialize::InputArchive& archive) {
    each(*this, [&](const char* name, StatisticsAccumulator& part) {
        part.set_state(to_vector(read_tensor(archive, std::string("statistics.") + name)));
    });
}

}  // namespace cloth
