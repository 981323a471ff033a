#pragma once

#include <string>
#include <vector>

#include "gnn/model/model_config.h"

namespace cloth {

/// A setting that two trainings or networks have with different values.
struct SettingDifference {
    std::string name;  ///< the option of `train`, where there is one
    std::string first, second;
};

/// A part of a text that tells the settings of a training: a label, then values between spaces.
struct SettingLabel {
    std::string label;
    std::vector<std::string> names;  ///< of the values in their order; the last one has the rest
    bool is_optional = false;        ///< may be missing, and stands at the end of the label before
};

std::vector<SettingDifference> differences(const ModelConfig& first, const ModelConfig& second);

/// @param first, second  a network's configuration as JSON, then the parts in the order of `labels`
/// @return  nothing if a text is not of that form, too
std::vector<SettingDifference> differences(const std::string& first, const std::string& second,
                                           const std::vector<SettingLabel>& labels);

/// "--width 16 (SECOND 32), --steps 6 (SECOND 8)"
/// @param second  what has the second values
std::string to_text(const std::vector<SettingDifference>& differences, const std::string& second);

/// The options of `train` for a network: "--variant fast --width 16 --steps 6".
std::string options_of(const ModelConfig& config);

}  // namespace cloth
