#include "gnn/train/parameters.h"

#include <cmath>
#include <random>

#include "data/core/errors.h"

namespace cloth {

static std::int64_t element_count(const std::vector<int>& shape) {
    std::int64_t count = 1;
    for (int size : shape) count *= size;
    return count;
}

Parameters::Parameters(const std::vector<TensorShape>& shapes, const std::string& output,
                       torch::Device device, std::uint64_t seed) {
    std::int64_t count = 0;
    for (const auto& [name, shape] : shapes) count += element_count(shape);
    m_flat = torch::zeros({count}, torch::kFloat32).to(device);
    m_gradient = torch::zeros_like(m_flat);
    std::int64_t offset = 0;
    for (const auto& [name, shape] : shapes) {
        const std::vector<std::int64_t> sizes(shape.begin(), shape.end());
        const std::int64_t size = element_count(shape);
        // detach: the view becomes a leaf of the autograd graph that shares the flat memory.
        torch::Tensor view = m_flat.narrow(0, offset, size).view(sizes).detach();
        view.set_requires_grad(true);
        view.mutable_grad() = m_gradient.narrow(0, offset, size).view(sizes);
        m_views.emplace(name, view);
        offset += size;
    }
    initialise(shapes, output, seed);
}

/// Number of inputs that the linear layer of a weight or bias sums over.
static double fan_in(const std::string& name, const std::vector<TensorShape>& shapes) {
    const std::string first = ".first.";
    const size_t at = name.find(first);
    if (at == std::string::npos) {
        const std::string weight = name.substr(0, name.rfind('.')) + ".weight";
        for (const auto& [other, shape] : shapes)
            if (other == weight && shape.size() == 2) return shape[1];
        return 1.0;
    }
    double inputs = 0.0;
    for (const auto& [other, shape] : shapes)
        if (other.rfind(name.substr(0, at + first.size()), 0) == 0 && shape.size() == 2)
            inputs += shape[1];
    return inputs;
}

void Parameters::initialise(const std::vector<TensorShape>& shapes, const std::string& output,
                            std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (const auto& [name, shape] : shapes) {
        std::vector<float> values(static_cast<size_t>(element_count(shape)), 0.0f);
        if (name.find(".norm.weight") != std::string::npos) {
            values.assign(values.size(), 1.0f);
        } else if (name.find(".norm.bias") == std::string::npos) {
            const double shrink = name.rfind(output, 0) == 0 ? 0.1 : 1.0;
            const double bound = shrink / std::sqrt(fan_in(name, shapes));
            // 53 random bits by hand: std::uniform_real_distribution differs between libraries
            for (float& value : values)
                value = static_cast<float>(
                    bound * (2.0 * static_cast<double>(random() >> 11) * 0x1.0p-53 - 1.0));
        }
        const std::vector<std::int64_t> sizes(shape.begin(), shape.end());
        torch::NoGradGuard no_grad;
        m_views.at(name).copy_(torch::tensor(values).view(sizes));
    }
}

const torch::Tensor& Parameters::view(const std::string& name) const {
    const auto found = m_views.find(name);
    if (found == m_views.end())
        throw ArgumentError("parameter " + name, "is not part of this network",
                            "see parameter_shapes() for the names");
    return found->second;
}

void Parameters::copy_to(std::map<std::string, WeightTensor>& tensors) const {
    for (const auto& [name, view] : m_views) {
        const torch::Tensor values = view.detach().to(torch::kCPU).contiguous();
        const float* data = values.data_ptr<float>();
        const std::vector<int> shape(values.sizes().begin(), values.sizes().end());
        tensors[name] = {shape, std::vector<float>(data, data + values.numel())};
    }
}

void Parameters::copy_from(const std::map<std::string, WeightTensor>& tensors) {
    torch::NoGradGuard no_grad;
    for (auto& [name, view] : m_views) {
        const auto found = tensors.find(name);
        if (found == tensors.end())
            throw ArgumentError("tensor " + name, "is missing", "give all tensors of the network");
        view.copy_(torch::tensor(found->second.data).view(view.sizes()));
    }
}

}  // namespace cloth
