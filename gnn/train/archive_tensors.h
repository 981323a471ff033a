#pragma once

#include <torch/torch.h>

#include <string>

#include "data/core/types.h"

namespace cloth {

/// A copy (double precision).
inline torch::Tensor to_tensor(const Points& points) {
    return torch::from_blob(const_cast<double*>(points.data()), {points.rows(), 3}, torch::kFloat64)
        .clone();
}

inline Points to_points(const torch::Tensor& tensor) {
    const torch::Tensor own = tensor.cpu().contiguous();
    return Eigen::Map<const Points>(own.data_ptr<double>(), own.size(0), 3);
}

/// A copy (double precision).
inline torch::Tensor to_tensor(const Eigen::VectorXd& values) {
    return torch::from_blob(const_cast<double*>(values.data()), {values.size()}, torch::kFloat64)
        .clone();
}

inline Eigen::VectorXd to_vector(const torch::Tensor& tensor) {
    const torch::Tensor own = tensor.cpu().contiguous();
    return Eigen::Map<const Eigen::VectorXd>(own.data_ptr<double>(), own.numel());
}

inline torch::Tensor read_tensor(torch::serialize::InputArchive& archive, const std::string& key) {
    torch::Tensor tensor;
    archive.read(key, tensor);
    return tensor;
}

}  // namespace cloth
