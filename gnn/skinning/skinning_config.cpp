#include "gnn/skinning/skinning_config.h"

#include <nlohmann/json.hpp>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/files/json_integers.h"

namespace cloth {

using nlohmann::json;

int SkinningConfig::feature_count() const {
    const int inner = 6 * (static_cast<int>(joints.size()) - 1);
    const int past = static_cast<int>(ages.size()) - 1;
    return 3 + inner + past * (inner + 9);
}

void SkinningConfig::check() const {
    check_range("SkinningConfig.vertices", vertices, 3, 100000);
    check_range("SkinningConfig.joints", static_cast<double>(joints.size()), 1, 100);
    check_range("SkinningConfig.ages", static_cast<double>(ages.size()), 1, 20);
    check_range("SkinningConfig.ages[0]", ages[0], 0, 0);
    for (size_t k = 1; k < ages.size(); ++k)
        check_range("SkinningConfig.ages[" + std::to_string(k) + "]", ages[k], ages[k - 1] + 1,
                    100);
    check_range("SkinningConfig.layers", static_cast<double>(layers.size()), 1, 10);
    for (const int width : layers) check_range("SkinningConfig.layers", width, 1, 2048);
    check_range("SkinningConfig.scale", scale, 1e-4, 1.0);
    check_range("SkinningConfig.dt", dt, 1e-4, 1.0);
}

std::string SkinningConfig::to_json() const {
    return json{{"garment", garment}, {"vertices", vertices}, {"joints", joints}, {"ages", ages},
                {"layers", layers},   {"scale", scale},       {"dt", dt}}
        .dump();
}

SkinningConfig SkinningConfig::from_json(const std::string& text, const std::string& file) {
    SkinningConfig config;
    try {
        const json fields = json::parse(text);
        fields.at("garment").get_to(config.garment);
        read_integer(fields.at("vertices"), "vertices", config.vertices);
        fields.at("joints").get_to(config.joints);
        read_integer(fields.at("ages"), "ages", config.ages);
        read_integer(fields.at("layers"), "layers", config.layers);
        fields.at("scale").get_to(config.scale);
        fields.at("dt").get_to(config.dt);
        config.check();
    } catch (const json::exception& error) {
        throw LoadError(file, "header, config", error.what(), "train the network again");
    } catch (const ArgumentError& error) {
        throw LoadError(file, "header, config", error.what(), "train the network again");
    }
    return config;
}

std::vector<TensorShape> tensor_shapes(const SkinningConfig& config) {
    std::vector<TensorShape> shapes;
    int inputs = config.feature_count();
    std::vector<int> widths = config.layers;
    widths.push_back(3 * config.vertices);
    for (size_t k = 0; k < widths.size(); ++k) {
        const std::string layer = "layer." + std::to_string(k);
        shapes.emplace_back(layer + ".weight", std::vector<int>{widths[k], inputs});
        shapes.emplace_back(layer + ".bias", std::vector<int>{widths[k]});
        inputs = widths[k];
    }
    shapes.emplace_back("input.mean", std::vector<int>{config.feature_count()});
    shapes.emplace_back("input.deviation", std::vector<int>{config.feature_count()});
    shapes.emplace_back("rest", std::vector<int>{config.vertices, 3});
    shapes.emplace_back("worn", std::vector<int>{config.vertices, 3});
    shapes.emplace_back("skin",
                        std::vector<int>{config.vertices, static_cast<int>(config.joints.size())});
    return shapes;
}

}  // namespace cloth
