#include "gnn/train/checkpoint_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "data/core/errors.h"

namespace cloth {

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
            throw LoadError(file, "", "cannot be read, or is empty",
                            "delete the file to start training again");
    }
    std::istringstream content(group.from_first(bytes.str()));
    if (content.str().empty()) return false;
    try {
        torch::serialize::InputArchive archive;
        archive.load_from(content, device);
        load(archive, file);
    } catch (const c10::Error& error) {
        throw LoadError(file, "", error.what_without_backtrace(),
                        "delete the file to start training again");
    }
    return true;
}

void check_checkpoint_settings(torch::serialize::InputArchive& archive, const std::string& file,
                               const std::string& own) {
    c10::IValue settings;
    archive.read("settings", settings);
    if (settings.toStringRef() != own)
        throw LoadError(file, "settings",
                        "the checkpoint is of another training: " + settings.toStringRef(),
                        "resume with the settings it was started with: " + own);
}

}  // namespace cloth
