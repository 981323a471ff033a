#include "gnn/train/validation_names.h"

#include <algorithm>
#include <filesystem>

#include "data/body/motion.h"
#include "data/core/errors.h"
#include "data/core/paths.h"

namespace cloth {

/// All of the shared data folder, or the one that is always there.
static std::vector<std::string> all_clips(const std::string& other_remedy) {
    const auto folder = shared_data_path("motions/validation");
    if (!folder) return {"01_01"};
    std::vector<std::string> clips = list_motions(*folder);
    if (clips.empty())
        throw LoadError(*folder, "", "has no motion to validate with",
                        "put BVH files there, or " + other_remedy);
    return clips;
}

std::vector<std::string> validation_clips() {
    std::vector<std::string> files = all_clips("name another folder by CLOTH_SHARED_DATA");
    const std::vector<std::string> wanted = {"07_02", "16_35"};
    const bool has_them = std::all_of(wanted.begin(), wanted.end(), [&](const std::string& name) {
        return std::any_of(files.begin(), files.end(), [&](const std::string& file) {
            const std::string stem = std::filesystem::path(file).stem().string();
            return stem == name || stem.rfind(name + "_", 0) == 0;
        });
    });
    if (has_them) return wanted;
    files.resize(std::min<size_t>(files.size(), 2));
    return files;
}

std::vector<std::string> default_rollout_clips() {
    return all_clips("give --validation-clips");
}

static void check_clip(const std::string& clip) {
    try {
        load_motion_by_name(clip);
    } catch (const LoadError& error) {
        const std::string text = error.what(), mark = ". Remedy: ";
        const size_t at = text.find(mark);
        if (at == std::string::npos) throw;
        throw LoadError("--validation-clips", "", text.substr(0, at),
                        text.substr(at + mark.size()));
    }
}

void check_clips(const std::vector<std::string>& clips) {
    for (const std::string& clip : clips) check_clip(clip);
}

std::string clip_name(const std::string& clip, const std::vector<std::string>& clips) {
    const auto stem = [](const std::string& path) {
        return std::filesystem::path(path).stem().string();
    };
    const bool is_unique = std::none_of(clips.begin(), clips.end(), [&](const std::string& other) {
        return other != clip && stem(other) == stem(clip);
    });
    return is_unique ? stem(clip) : clip;
}

std::vector<size_t> validated_garments(const std::vector<std::string>& chosen,
                                       const std::vector<std::string>& known) {
    std::vector<size_t> places;
    const auto add = [&](const std::string& name) {
        const auto found = std::find(known.begin(), known.end(), name);
        if (found == known.end()) return false;
        places.push_back(static_cast<size_t>(found - known.begin()));
        return true;
    };
    for (const std::string& name : chosen) {
        if (add(name)) continue;
        std::string names;
        for (const std::string& one : known) names += (names.empty() ? "" : ", ") + one;
        throw ArgumentError("--validation-garments", name + " is not trained on",
                            known.empty() ? "leave it out, or train on garments (--garment-share)"
                                          : "choose among " + names);
    }
    if (!chosen.empty() || known.empty()) return places;
    for (const char* name : {"tshirt", "pants_1000", "dress_1000"}) add(name);
    if (places.empty()) places.push_back(known.size() - 1);
    return places;
}

}  // namespace cloth
