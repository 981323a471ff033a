#include "gnn/train/setting_differences.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "gnn/train/loss.h"

namespace cloth {

using nlohmann::json;

namespace {

using Values = std::map<std::string, std::string>;
const char* const steps_of_levels = "levels of each step";

/// What a value of ModelConfig::to_json() or SkinningConfig::to_json() is in options.
std::pair<std::string, std::string> option_of(const std::string& key, const json& value) {
    static const std::map<std::string, std::string> names = {
        {"variant", "--variant"},
        {"steps", "--steps"},
        {"width", "--width"},
        {"sampled_edges", "--sampled-edges"},
        {"layers", "--layers"},
        {"ages", "--ages"},
        {"level_schedule", "--levels"},
        {"dt", "--rate"},
        {"force_features", "--force-features"}};
    const auto found = names.find(key);
    if (found == names.end()) return {key, value.dump()};
    std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (key == "dt" && value.is_number()) {
        std::ostringstream rate;
        rate << 1.0 / value.get<double>();
        text = rate.str();
    }
    if (key == "level_schedule" && value.is_array())
        text = std::to_string(coarsest_level(value.get<LevelSchedule>()));
    if (value.is_boolean()) text = value.get<bool>() ? "1" : "0";
    return {found->second, text};
}

void add_json(const std::string& text, Values& values) {
    const json parsed = json::parse(text, nullptr, false);
    if (!parsed.is_object()) return;
    for (const auto& [key, value] : parsed.items()) {
        values.insert(option_of(key, value));
        if (key == "level_schedule") values[steps_of_levels] = value.dump();
    }
}

/// A loss stands in the texts as the number of its LossKind.
std::string loss_text(const std::string& number) {
    for (const char* name : {"energy", "log", "both"})
        if (number == std::to_string(static_cast<int>(loss_named(name)))) return name;
    return number;
}

std::vector<std::string> words_of(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
}

void add_words(const std::string& text, const std::vector<std::string>& names, Values& values) {
    const std::vector<std::string> words = words_of(text);
    if (words.empty() && !names.empty()) values[names[0]] = "given";  // the label says it all
    for (size_t k = 0; k < words.size(); ++k) {
        const std::string& name = names[std::min(k, names.size() - 1)];
        std::string& value = values[name];
        value += (value.empty() ? "" : " ") + (name == "--loss" ? loss_text(words[k]) : words[k]);
    }
}

/// Nothing if the text is not of that form.
std::optional<Values> parse(const std::string& settings, const std::vector<SettingLabel>& labels) {
    const std::string text = settings + " ";  // the last label may have no value
    struct Found {
        const SettingLabel* label;
        size_t begin, end;  ///< of the label
    };
    std::vector<Found> found;
    size_t at = text.find('}');
    if (at == std::string::npos) return std::nullopt;
    Values values;
    add_json(text.substr(0, at + 1), values);
    for (const SettingLabel& label : labels) {
        const size_t place = text.find(" " + label.label + " ", at);
        if (place == std::string::npos && !label.is_optional) return std::nullopt;
        if (place == std::string::npos) continue;
        at = place + label.label.size() + 1;
        found.push_back({&label, place, at});
    }
    for (size_t k = 0; k < found.size(); ++k) {
        const size_t end = k + 1 < found.size() ? found[k + 1].begin : text.size();
        add_words(text.substr(found[k].end, end - found[k].end), found[k].label->names, values);
    }
    return values;
}

std::vector<SettingDifference> compared(const Values& first, const Values& second) {
    Values all = first;
    all.insert(second.begin(), second.end());
    const auto value_in = [](const Values& values, const std::string& name) {
        const auto found = values.find(name);
        return found == values.end() ? std::string("none") : found->second;
    };
    const auto differ = [&](const std::string& name) {
        return value_in(first, name) != value_in(second, name);
    };
    std::set<std::string> implied;  // by options that differ themselves
    if (differ("--variant")) implied = {"pooling", "world_every_step", "body_updates"};
    if (differ("--levels") || differ("--steps")) implied.insert(steps_of_levels);
    std::vector<SettingDifference> result;
    for (const auto& [name, value] : all) {
        if (differ(name) && implied.count(name) == 0)
            result.push_back({name, value_in(first, name), value_in(second, name)});
    }
    return result;
}

}  // namespace

std::vector<SettingDifference> differences(const ModelConfig& first, const ModelConfig& second) {
    Values a, b;
    add_json(first.to_json(), a);
    add_json(second.to_json(), b);
    return compared(a, b);
}

std::vector<SettingDifference> differences(const std::string& first, const std::string& second,
                                           const std::vector<SettingLabel>& labels) {
    const auto a = parse(first, labels), b = parse(second, labels);
    if (!a || !b) return {};
    return compared(*a, *b);
}

std::string to_text(const std::vector<SettingDifference>& differences, const std::string& second) {
    std::string text;
    for (const SettingDifference& one : differences)
        text += (text.empty() ? "" : ", ") + one.name + " " + one.first + " (" + second + " " +
                one.second + ")";
    return text;
}

std::string options_of(const ModelConfig& config) {
    std::ostringstream text;
    text << "--variant " << config.variant << " --width " << config.width << " --steps "
         << config.steps;
    const int levels = coarsest_level(config.level_schedule);
    if (levels > 0) text << " --levels " << levels;
    if (config.sampled_edges > 0) text << " --sampled-edges " << config.sampled_edges;
    if (!config.features.force_features) text << " --force-features 0";
    return text.str();
}

}  // namespace cloth
