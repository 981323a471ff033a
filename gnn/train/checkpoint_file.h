#pragma once

#include <torch/serialize/archive.h>

#include <functional>
#include <string>
#include <vector>

#include "gnn/train/process_group.h"
#include "gnn/train/setting_differences.h"

namespace cloth {

/// Replaces the checkpoint of a folder: written under a temporary name, then renamed.
void save_checkpoint(torch::serialize::OutputArchive& archive, const std::string& folder);

/// Reads the checkpoint of a folder with `load(archive, file)`. The first process reads the file
/// for all: the others may be on machines that have none.
/// @return  false: there is none
/// @throws LoadError if it cannot be read; what `load` throws
bool load_checkpoint(
    const std::string& folder, const ProcessGroup& group, const c10::Device& device,
    const std::function<void(torch::serialize::InputArchive&, const std::string&)>& load);

/// @param own     the settings of this training, as the entry "settings" of its checkpoints has
/// them
/// @param labels  of that text, to name what differs
/// @throws LoadError if the archive is of another training
void check_checkpoint_settings(torch::serialize::InputArchive& archive, const std::string& file,
                               const std::string& own, const std::vector<SettingLabel>& labels);

/// @param differences  of the checkpoint from the training that is to go on with it
/// @throws LoadError naming them if there are any
void refuse_differences(const std::string& file, const std::vector<SettingDifference>& differences);

}  // namespace cloth
