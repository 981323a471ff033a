#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gnn/graph/features.h"
#include "gnn/model/tensor_file.h"

namespace cloth {

/// What the network is. The four variants of the paper's ablation differ in three switches; those
/// with coarse levels add how these are made, and which of them a step uses.
///
/// | variant   | sampled_edges | world_every_step | body_updates | pooling  |
/// |-----------|---------------|------------------|--------------|----------|
/// | baseline  | 0 (all)       | yes              | yes          | none     |
/// | sampling  | 4             | yes              | yes          | none     |
/// | reduction | 0 (all)       | first step only  | no           | none     |
/// | fast      | 4             | first step only  | no           | none     |
/// | hood      | 0 (all)       | yes              | yes          | hood     |
/// | hood_fast | 4             | first step only  | no           | hood     |
/// | bistride  | 0 (all)       | yes              | yes          | bistride |
///
/// The paper's reduction keeps one message from garment to body, in the last step. Only garment
/// nodes are decoded, so that message never reaches the output: it is left out.
struct ModelConfig {
    static constexpr int format_version = 1;

    std::string variant = "fast";
    int steps = 21;                   ///< message passing steps, 1 to 64
    int width = 128;                  ///< latent size, 4 to 512
    int hidden_layers = 2;            ///< per multilayer perceptron, 1 to 4
    int sampled_edges = 4;            ///< incoming edges per vertex and step, 0 to 32; 0: all
    bool world_every_step = false;    ///< body to garment messages in every step, or the first only
    bool body_updates = false;        ///< garment to body messages change the body nodes
    double message_scale = 0.4;       ///< factor on the sum of a vertex's messages, 1e-3 to 10
    std::uint64_t schedule_seed = 1;  ///< of the sampling schedule
    double dt = 1.0 / 30.0;           ///< time step that the network is trained for (s), 1e-4 to 1
    FeatureSettings features;
    Pooling pooling = Pooling::none;  ///< how coarse levels are made, if there are any
    LevelSchedule level_schedule;     ///< levels that a step uses; without pooling: empty

    /// @param count   of message passing steps; 0: the variant's own, 15 with coarse levels, else
    /// 21
    /// @param levels  coarse ones, if the variant has any
    /// @throws ArgumentError if `name` is not one of variant_names(), or as down_and_up() does
    static ModelConfig variant_named(const std::string& name, int count = 0, int levels = 2);
    static const std::vector<std::string>& variant_names();

    bool has_world(int step) const { return world_every_step || step == 0; }
    GraphSettings graph_settings() const {
        return {steps, sampled_edges, schedule_seed, pooling, level_schedule};
    }

    /// Levels that send messages in a step, finest first; 0 is the mesh. One or two. The step
    /// updates the nodes of the first.
    const std::vector<int>& levels(int step) const;
    /// Levels in use, ascending: {0} without pooling.
    std::vector<int> used_levels() const;
    /// Whether a later step sends messages along the edges of `level`.
    bool uses_after(int level, int step) const;

    /// @throws ArgumentError naming the field that is out of range
    void check() const;

    std::string to_json() const;
    /// @param file  named in errors
    /// @throws LoadError for a field that is missing, of the wrong type or out of range
    static ModelConfig from_json(const std::string& text, const std::string& file);
};

bool operator==(const ModelConfig& a, const ModelConfig& b);

/// Parts of the network that belong to a level are named after it: "edge" and "mesh" of the mesh,
/// "edge1" and "mesh1" of level 1.
std::string level_name(const std::string& part, int level);

/// Learned tensors in a fixed order. A multilayer perceptron NAME has NAME.first.INPUT.weight for
/// each of its inputs (the first layer is split: the sum over the inputs of weight x input equals
/// one matrix times their concatenation), NAME.first.bias, NAME.hidden.K.{weight,bias},
/// NAME.output.{weight,bias} and, but for the decoder, NAME.norm.{weight,bias}. Weights are
/// (outputs x inputs).
std::vector<TensorShape> parameter_shapes(const ModelConfig& config);

/// Normalisation of the features: statistics.{node,edge,world,body}.{mean,deviation}.
std::vector<TensorShape> statistics_shapes(const ModelConfig& config);

}  // namespace cloth
