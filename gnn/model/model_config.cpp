#include "gnn/model/model_config.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/files/json_integers.h"

namespace cloth {

using nlohmann::json;

const std::vector<std::string>& ModelConfig::variant_names() {
    static const std::vector<std::string> names = {"baseline", "sampling",  "reduction", "fast",
                                                   "hood",     "hood_fast", "bistride"};
    return names;
}

ModelConfig ModelConfig::variant_named(const std::string& name, int count, int levels) {
    const auto& names = variant_names();
    if (std::find(names.begin(), names.end(), name) == names.end())
        throw ArgumentError("variant '" + name + "'", "is not a network variant",
                            "use baseline, sampling, reduction, fast, hood, hood_fast or bistride");
    ModelConfig config;
    config.variant = name;
    const bool fast = name == "fast" || name == "hood_fast";
    const bool sampling = fast || name == "sampling", reduction = fast || name == "reduction";
    config.sampled_edges = sampling ? 4 : 0;
    config.world_every_step = !reduction;
    config.body_updates = !reduction;
    if (name == "hood" || name == "hood_fast") config.pooling = Pooling::hood;
    if (name == "bistride") config.pooling = Pooling::bistride;
    const bool is_flat = config.pooling == Pooling::none;
    config.steps = count != 0 ? count : is_flat ? 21 : 15;
    if (!is_flat) config.level_schedule = down_and_up(config.steps, levels);
    return config;
}

const std::vector<int>& ModelConfig::levels(int step) const {
    static const std::vector<int> mesh = {0};
    return level_schedule.empty() ? mesh : level_schedule[static_cast<size_t>(step)];
}

std::vector<int> ModelConfig::used_levels() const {
    std::set<int> used;
    for (int k = 0; k < steps; ++k) used.insert(levels(k).begin(), levels(k).end());
    return {used.begin(), used.end()};
}

bool ModelConfig::uses_after(int level, int step) const {
    for (int k = step + 1; k < steps; ++k)
        if (levels(k).front() == level || levels(k).back() == level) return true;
    return false;
}

std::string ModelConfig::to_json() const {
    json j{{"variant", variant},
           {"steps", steps},
           {"width", width},
           {"hidden_layers", hidden_layers},
           {"sampled_edges", sampled_edges},
           {"world_every_step", world_every_step},
           {"body_updates", body_updates},
           {"message_scale", message_scale},
           {"schedule_seed", schedule_seed},
           {"dt", dt},
           {"force_features", features.force_features},
           {"world_radius", features.world_radius}};
    if (pooling != Pooling::none) {  // files of networks without it are as they always were
        j["pooling"] = pooling_name(pooling);
        j["level_schedule"] = level_schedule;
    }
    return j.dump();
}

void ModelConfig::check() const {
    check_range("ModelConfig.steps", steps, 1, 64);
    check_range("ModelConfig.width", width, 4, 512);
    check_range("ModelConfig.hidden_layers", hidden_layers, 1, 4);
    check_range("ModelConfig.sampled_edges", sampled_edges, 0, 32);
    check_range("ModelConfig.message_scale", message_scale, 1e-3, 10.0);
    check_range("ModelConfig.dt", dt, 1e-4, 1.0);
    check_range("ModelConfig.features.world_radius", features.world_radius, 1e-3, 1.0);
    check_levels("ModelConfig", steps, pooling, level_schedule);
}

ModelConfig ModelConfig::from_json(const std::string& text, const std::string& file) {
    ModelConfig c;
    try {
        const json j = json::parse(text);
        j.at("variant").get_to(c.variant);
        read_integer(j.at("steps"), "steps", c.steps);
        read_integer(j.at("width"), "width", c.width);
        read_integer(j.at("hidden_layers"), "hidden_layers", c.hidden_layers);
        read_integer(j.at("sampled_edges"), "sampled_edges", c.sampled_edges);
        j.at("world_every_step").get_to(c.world_every_step);
        j.at("body_updates").get_to(c.body_updates);
        j.at("message_scale").get_to(c.message_scale);
        read_integer(j.at("schedule_seed"), "schedule_seed", c.schedule_seed);
        j.at("dt").get_to(c.dt);
        j.at("force_features").get_to(c.features.force_features);
        j.at("world_radius").get_to(c.features.world_radius);
        c.pooling = pooling_named(j.value("pooling", "none"));
        if (c.pooling != Pooling::none)
            read_integer(j.at("level_schedule"), "level_schedule", c.level_schedule);
        c.check();
    } catch (const json::exception& error) {
        throw LoadError(file, "configuration", error.what(), "export the network again");
    } catch (const ArgumentError& error) {
        throw LoadError(file, "configuration", error.what(), "export the network again");
    }
    return c;
}

bool operator==(const ModelConfig& a, const ModelConfig& b) {
    return a.to_json() == b.to_json();
}

namespace {

using Sizes = std::vector<std::pair<std::string, int>>;  ///< names of inputs, and their widths

struct ShapeList {
    std::vector<TensorShape> shapes;
    int width, hidden_layers;

    void add_mlp(const std::string& name, const Sizes& inputs, int outputs, bool norm) {
        for (const auto& [input, size] : inputs)
            shapes.push_back({name + ".first." + input + ".weight", {width, size}});
        shapes.push_back({name + ".first.bias", {width}});
        for (int layer = 1; layer < hidden_layers; ++layer)
            add_linear(name + ".hidden." + std::to_string(layer), width);
        add_linear(name + ".output", outputs);
        if (norm) {
            shapes.push_back({name + ".norm.weight", {outputs}});
            shapes.push_back({name + ".norm.bias", {outputs}});
        }
    }

    void add_linear(const std::string& name, int outputs) {
        shapes.push_back({name + ".weight", {outputs, width}});
        shapes.push_back({name + ".bias", {outputs}});
    }
};

Sizes feature_sizes(const ModelConfig& config) {
    return {{"node", feature_count(node_layout(config.features.force_features))},
            {"edge", feature_count(edge_layout())},
            {"world", feature_count(world_layout())},
            {"body", feature_count(body_layout())}};
}

/// Edges of each level have an encoder of their own.
Sizes encoder_sizes(const ModelConfig& config) {
    Sizes sizes = feature_sizes(config);
    for (const int level : config.used_levels())
        if (level > 0) sizes.push_back({level_name("edge", level), feature_count(edge_layout())});
    return sizes;
}

}  // namespace

std::string level_name(const std::string& part, int level) {
    return level == 0 ? part : part + std::to_string(level);
}

std::vector<TensorShape> parameter_shapes(const ModelConfig& config) {
    const int d = config.width;
    ShapeList list{{}, d, config.hidden_layers};
    for (const auto& [name, size] : encoder_sizes(config))
        list.add_mlp("encoder." + name, {{"features", size}}, d, true);
    for (int k = 0; k < config.steps; ++k) {
        const std::string step = "step." + std::to_string(k);
        const Sizes ends_and_edge = {{"receiver", d}, {"sender", d}, {"edge", d}};
        Sizes inputs = {{"node", d}};
        for (const int level : config.levels(k)) {
            list.add_mlp(step + "." + level_name("edge", level), ends_and_edge, d, true);
            inputs.push_back({level_name("mesh", level), d});
        }
        if (config.has_world(k)) list.add_mlp(step + ".world", ends_and_edge, d, true);
        if (config.has_world(k)) inputs.push_back({"world", d});
        list.add_mlp(step + ".node", inputs, d, true);
    }
    list.add_mlp("decoder", {{"node", d}}, 3, false);
    return list.shapes;
}

std::vector<TensorShape> statistics_shapes(const ModelConfig& config) {
    std::vector<TensorShape> shapes;
    for (const auto& [name, size] : feature_sizes(config)) {
        shapes.push_back({"statistics." + name + ".mean", {size}});
        shapes.push_back({"statistics." + name + ".deviation", {size}});
    }
    return shapes;
}

}  // namespace cloth
