#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>

namespace cloth {

/// What FastClothGNN reports: Zhang, Yu, Zhang, "FastClothGNN: Optimizing message passing in Graph
/// Neural Networks for accelerating real-time cloth simulation".

/// Tables 2 and 3, on an RTX 3090.
struct PaperInference {
    double fps, memory_mb, loss;
};
/// Tables 1 and 3. NaN: not reported.
struct PaperTraining {
    double hours = std::numeric_limits<double>::quiet_NaN();
    double s_per_iteration = std::numeric_limits<double>::quiet_NaN();
    double memory_gb = std::numeric_limits<double>::quiet_NaN();
};

/// The garments of table 2.
constexpr std::array<const char*, 3> paper_garments = {"tshirt", "pants", "dress"};

/// @param network  as here; `fast` is the paper's "ours"
/// @return nothing if the paper has no such row. HOOD's rows are for no particular garment
std::optional<PaperInference> paper_inference(const std::string& network,
                                              const std::string& garment);
std::optional<PaperTraining> paper_training(const std::string& network);

}  // namespace cloth
