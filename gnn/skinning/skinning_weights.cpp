#include "gnn/skinning/skinning_weights.h"

#include <algorithm>
#include <cmath>

#include "data/body/garment_skinning.h"
#include "data/core/errors.h"
#include "data/core/printable.h"

namespace cloth {

namespace {

const char* const train_again = "train the network again";

TensorProblem find_problem_of(const SkinningWeights& weights) {
    TensorProblem problem = find_problem(tensor_shapes(weights.config), weights.tensors);
    if (!problem.place.empty()) return problem;
    problem = find_bad_divisor("input.deviation", weights.tensor("input.deviation"));
    if (!problem.place.empty()) return problem;
    const std::vector<float>& skin = weights.tensor("skin").data;
    const size_t joints = weights.config.joints.size();
    for (size_t i = 0; i < skin.size(); i += joints) {
        double sum = 0.0;
        bool negative = false;
        for (size_t j = 0; j < joints; ++j) {
            sum += static_cast<double>(skin[i + j]);
            negative = negative || skin[i + j] < 0.0f;
        }
        if (negative || std::abs(sum - 1.0) > 1e-3)
            return {"tensor skin",
                    "row " + std::to_string(i / joints) + " is not a mean: it must sum to 1"};
    }
    return {};
}

WeightTensor to_tensor(const Points& points) {
    const auto values = points.cast<float>().eval();
    return {{static_cast<int>(points.rows()), 3}, {values.data(), values.data() + values.size()}};
}

/// Joints with a part in `weights`, and those between them and the root.
std::vector<int> joints_of(const Body& body, const SkinWeights& weights) {
    std::vector<char> used(body.joints().size(), 0);
    for (int joint : weights.joints)
        for (int j = joint; j >= 0 && !used[static_cast<size_t>(j)];
             j = body.joints()[static_cast<size_t>(j)].parent)
            used[static_cast<size_t>(j)] = 1;
    std::vector<int> joints;
    for (size_t j = 0; j < used.size(); ++j)
        if (used[j]) joints.push_back(static_cast<int>(j));
    return joints;
}

}  // namespace

SkinningWeights SkinningWeights::load(const std::string& file) {
    TensorFile raw = TensorFile::load(file);
    if (raw.entry("format", file) != "fastcloth-skinning")
        throw LoadError(file, "header, format", "is not fastcloth-skinning",
                        "use a file that train_skinning wrote");
    const std::string version = raw.entry("version", file);
    if (version != std::to_string(SkinningConfig::format_version))
        throw LoadError(file, "header, version",
                        "is " + printable(version) + " where this program reads " +
                            std::to_string(SkinningConfig::format_version),
                        train_again);
    SkinningWeights weights;
    weights.config = SkinningConfig::from_json(raw.entry("config", file), file);
    weights.tensors = std::move(raw.tensors);
    const TensorProblem problem = find_problem_of(weights);
    if (!problem.place.empty()) throw LoadError(file, problem.place, problem.text, train_again);
    return weights;
}

void SkinningWeights::save(const std::string& file) const {
    config.check();
    const TensorProblem problem = find_problem_of(*this);
    if (!problem.place.empty())
        throw ArgumentError(problem.place, problem.text, "save the tensors of the configuration");
    const TensorFile raw{{{"format", "fastcloth-skinning"},
                          {"version", std::to_string(SkinningConfig::format_version)},
                          {"config", config.to_json()}},
                         tensors};
    raw.save(file);
}

const WeightTensor& SkinningWeights::tensor(const std::string& name) const {
    const auto found = tensors.find(name);
    if (found == tensors.end())
        throw ArgumentError("tensor " + name, "is not part of this network",
                            "see tensor_shapes() for the names");
    return found->second;
}

Points SkinningWeights::points(const std::string& name) const {
    const std::vector<float>& data = tensor(name).data;
    using PointsF = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
    return Eigen::Map<const PointsF>(data.data(), static_cast<Eigen::Index>(data.size() / 3), 3)
        .cast<double>();
}

SkinWeights SkinningWeights::skin(const std::vector<int>& joint_index) const {
    const std::vector<float>& data = tensor("skin").data;
    const int last = *std::max_element(joint_index.begin(), joint_index.end());
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(config.vertices, last + 1);
    for (int i = 0; i < config.vertices; ++i)
        for (size_t j = 0; j < joint_index.size(); ++j)
            dense(i, joint_index[j]) =
                static_cast<double>(data[static_cast<size_t>(i) * joint_index.size() + j]);
    return sparse_weights(dense, last + 1, 0.0);
}

SkinningWeights untrained_skinning(const Garment& garment, const Points& worn,
                                   const AnimatedBody& body, SkinningConfig config) {
    const GarmentSkinning skinning = skin_garment(worn, body);
    const std::vector<int> joints = joints_of(body.body(), skinning.weights());
    config.garment = garment.name();
    config.vertices = garment.vertex_count();
    config.joints.clear();
    for (int joint : joints)
        config.joints.push_back(body.body().joints()[static_cast<size_t>(joint)].name);
    config.check();
    SkinningWeights weights{config, {}};
    for (const auto& [name, shape] : tensor_shapes(config)) {
        size_t count = 1;
        for (int size : shape) count *= static_cast<size_t>(size);
        weights.tensors[name] = {shape, std::vector<float>(count, 0.0f)};
    }
    std::vector<float>& deviation = weights.tensors["input.deviation"].data;
    std::fill(deviation.begin(), deviation.end(), 1.0f);
    weights.tensors["rest"] = to_tensor(garment.rest().vertices);
    weights.tensors["worn"] = to_tensor(worn);
    std::vector<float>& skin = weights.tensors["skin"].data;
    for (int i = 0; i < config.vertices; ++i)
        for (size_t j = 0; j < joints.size(); ++j)
            skin[static_cast<size_t>(i) * joints.size() + j] =
                static_cast<float>(skinning.weights().at(i, joints[j]));
    return weights;
}

}  // namespace cloth
