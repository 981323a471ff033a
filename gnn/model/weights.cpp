#include "gnn/model/weights.h"

#include <filesystem>

#include "data/core/errors.h"
#include "data/core/printable.h"
#include "gnn/model/weights_check.h"

namespace cloth {

namespace {

const char* const train_again = "train or export the network again";

std::vector<TensorShape> expected_tensors(const ModelConfig& config) {
    std::vector<TensorShape> shapes = parameter_shapes(config);
    for (TensorShape& shape : statistics_shapes(config)) shapes.push_back(std::move(shape));
    return shapes;
}

}  // namespace

TensorProblem find_problem(const Weights& weights) {
    const TensorProblem problem = find_problem(expected_tensors(weights.config), weights.tensors);
    if (!problem.place.empty()) return problem;
    for (const auto& [name, shape] : statistics_shapes(weights.config)) {
        if (name.find(".deviation") == std::string::npos) continue;
        const TensorProblem bad = find_bad_divisor(name, weights.tensors.at(name));
        if (!bad.place.empty()) return bad;
    }
    return {};
}

Weights Weights::load(const std::string& file) {
    TensorFile raw = TensorFile::load(file);
    if (raw.entry("format", file) != "fastcloth")
        throw LoadError(file, "header, format", "is not fastcloth",
                        "use a weights file written by this project");
    const std::string version = raw.entry("version", file);
    if (version != std::to_string(ModelConfig::format_version))
        throw LoadError(file, "header, version",
                        "is " + printable(version) + " where this program reads " +
                            std::to_string(ModelConfig::format_version),
                        train_again);
    Weights weights;
    weights.called = std::filesystem::path(file).stem().string();
    weights.config = ModelConfig::from_json(raw.entry("config", file), file);
    weights.tensors = std::move(raw.tensors);
    const TensorProblem problem = find_problem(weights);
    if (!problem.place.empty()) throw LoadError(file, problem.place, problem.text, train_again);
    return weights;
}

void Weights::save(const std::string& file) const {
    const TensorProblem problem = find_problem(*this);
    if (!problem.place.empty())
        throw ArgumentError(problem.place, problem.text, "save the tensors of the configuration");
    const TensorFile raw{{{"format", "fastcloth"},
                          {"version", std::to_string(ModelConfig::format_version)},
                          {"config", config.to_json()}},
                         tensors};
    raw.save(file);
}

const WeightTensor& Weights::tensor(const std::string& name) const {
    const auto found = tensors.find(name);
    if (found == tensors.end())
        throw ArgumentError("tensor " + name, "is not part of this network",
                            "see parameter_shapes() for the names");
    return found->second;
}

}  // namespace cloth
