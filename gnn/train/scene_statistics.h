#pragma once

#include <string>

#include "gnn/train/network.h"
#include "gnn/train/process_group.h"
#include "gnn/train/training_scene.h"

namespace cloth {

/// Mean and deviation of the features of training scenes.
class SceneStatistics {
 public:
    explicit SceneStatistics(const ModelConfig& config);

    void add(const Features& features);
    /// Becomes the one of all processes.
    void sum(const ProcessGroup& group);
    void clear();

    NetworkStatistics statistics() const;

    void write(torch::serialize::OutputArchive& archive) const;
    void read(torch::serialize::InputArchive& archive);

 private:
    template <typename Self, typename Visit>
    static void each(Self& self, const Visit& visit) {
        visit("node", self.m_node);
        visit("edge", self.m_edge);
        visit("world", self.m_world);
        visit("body", self.m_body);
    }

    StatisticsAccumulator m_node, m_edge, m_world, m_body;
};

}  // namespace cloth
