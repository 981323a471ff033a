#include "gnn/train/checkpoint_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "data/core/errors.h"

namespace cloth {

/// The weights beside a damaged checkpoint are whole.
static const char* const start_elsewhere =
    "train anew with another --out; `train` starts from the last weights that were saved with "
    "--weights and weights.safetensors of this folder";

static std::string checkpoint_of(const std::string& folder) {
    return folder + "/checkpoint.pt";
}

void save_checkpoint(torch::serialize::OutputArchive& archive, const std::string& folder) {
    const std::string file = checkpoint_of(folder), temporary = file + ".tmp";
    archive.save_to(temporary);
    std::filesystem::rename(temporary, file);
}

bool load_checkpoint(
    const std::string& folder, const ProcessGroup& group, const c10::Device& device,
    const std::function<void(torch::serialize::InputArchive&, const std::string&)>& load) {
    const std::string file = checkpoint_of(folder);
    std::ostringstream bytes;
    if (group.is_first() && std::filesystem::exists(file)) {
        std::ifstream stream(file, std::ios::binary);
        if (!(bytes << stream.rdbuf()))
            throw LoadError(file, "", "cannot be read, or is empty", start_elsewhere);
    }
    std::istringstream content(group.from_first(bytes.str()));
    if (content.str().empty()) return false;
    try {
        torch::serialize::InputArchive archive;
        archive.load_from(content, device);
        load(archive, file);
    } catch (const c10::Error& error) {
        throw LoadError(file, "", error.what_without_backtrace(), start_elsewhere);
    }
    return true;
}

void check_checkpoint_settings(torch::serialize::InputArchive& archive, const std::string& file,
                               const std::string& own, const std::vector<SettingLabel>& labels) {
    c10::IValue settings;
    archive.read("settings", settings);
    const std::string& kept = settings.toStringRef();
    if (kept == own) return;
    refuse_differences(file, differences(kept, own, labels));
    throw LoadError(file, "settings", "are of another program: " + kept,
                    "train anew with another --out");
}

void refuse_differences(const std::string& file,
                        const std::vector<SettingDifference>& differences) {
    if (differences.empty()) return;
    throw LoadError(file, "settings",
                    "the training was started with " + to_text(differences, "now"),
                    "resume with the options of then, or train anew with another --out");
}

}  // namespace cloth
