#include "gnn/model/weights.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "data/core/errors.h"
#include "data/core/printable.h"
#include "data/core/read_file.h"

namespace cloth {

using nlohmann::json;

namespace {

const char* const train_again = "train or export the network again";

std::vector<TensorShape> expected_tensors(const ModelConfig& config) {
    std::vector<TensorShape> shapes = parameter_shapes(config);
    for (TensorShape& shape : statistics_shapes(config)) shapes.push_back(std::move(shape));
    return shapes;
}

size_t element_count(const std::vector<int>& shape) {
    size_t count = 1;
    for (int size : shape) count *= static_cast<size_t>(size);
    return count;
}

std::string to_text(const std::vector<int>& shape) {
    return json(shape).dump();
}

/// What is wrong with a set of tensors; empty place: nothing.
struct Problem {
    std::string place, text;
};

/// Features are divided by their deviations.
bool is_divisor(float value) {
    return value > 0.0f && std::isfinite(1.0f / value);
}

Problem find_problem(const ModelConfig& config,
                     const std::map<std::string, WeightTensor>& tensors) {
    const auto expected = expected_tensors(config);
    for (const auto& [name, shape] : expected) {
        const auto found = tensors.find(name);
        if (found == tensors.end()) return {"tensor " + name, "is missing"};
        const WeightTensor& tensor = found->second;
        if (tensor.shape != shape || tensor.data.size() != element_count(shape))
            return {"tensor " + name, "has shape " + to_text(tensor.shape) +
                                          " where the configuration asks for " + to_text(shape)};
        for (size_t i = 0; i < tensor.data.size(); ++i)
            if (!std::isfinite(tensor.data[i]))
                return {"tensor " + name, "element " + std::to_string(i) + " is not finite"};
    }
    for (const auto& [name, shape] : statistics_shapes(config)) {
        if (name.find(".deviation") == std::string::npos) continue;
        const std::vector<float>& data = tensors.at(name).data;
        for (size_t i = 0; i < data.size(); ++i)
            if (!is_divisor(data[i]))
                return {"tensor " + name, "element " + std::to_string(i) + " is not positive"};
    }
    if (tensors.size() != expected.size())
        return {"tensors", "there are " + std::to_string(tensors.size()) +
                               ", the configuration has " + std::to_string(expected.size())};
    return {};
}

/// The parsed file: header and the bytes behind it.
struct RawFile {
    json header;
    std::string bytes;
};

RawFile read_raw(const std::string& file) {
    const std::string all = read_file(file);
    std::uint64_t length = 0;
    if (all.size() < sizeof length)
        throw LoadError(file, "header", "the file is truncated", train_again);
    std::memcpy(&length, all.data(), sizeof length);
    if (length > all.size() - sizeof length)
        throw LoadError(file, "header", "the file is truncated or not in safetensors format",
                        train_again);
    const auto begin = all.begin() + sizeof length;
    const auto end = begin + static_cast<std::ptrdiff_t>(length);
    RawFile raw{json::parse(begin, end, nullptr, false), {end, all.end()}};
    if (!raw.header.is_object())
        throw LoadError(file, "header", "is not a JSON object", train_again);
    return raw;
}

std::string metadata(const RawFile& raw, const std::string& file, const char* key) {
    const json::json_pointer pointer(std::string("/__metadata__/") + key);
    if (!raw.header.contains(pointer) || !raw.header[pointer].is_string())
        throw LoadError(file, std::string("header, __metadata__.") + key, "is missing",
                        "use a weights file written by this project");
    return raw.header[pointer].get<std::string>();
}

WeightTensor read_tensor(const RawFile& raw, const json& entry, const std::string& place,
                         const std::string& file) {
    WeightTensor tensor;
    std::uint64_t begin = 0, end = 0;
    try {
        if (entry.at("dtype") != "F32")
            throw LoadError(file, place, "is not of type F32", "store float32 numbers");
        entry.at("shape").get_to(tensor.shape);
        entry.at("data_offsets").at(0).get_to(begin);
        entry.at("data_offsets").at(1).get_to(end);
    } catch (const json::exception& error) {
        throw LoadError(file, place, error.what(), train_again);
    }
    for (int size : tensor.shape)
        if (size < 1 || size > (1 << 20))
            throw LoadError(file, place, "has an unusable shape", train_again);
    if (begin > end || end > raw.bytes.size())
        throw LoadError(file, place, "lies outside the file: it is truncated", train_again);
    if ((end - begin) != element_count(tensor.shape) * sizeof(float))
        throw LoadError(file, place, "has a size that does not fit its shape", train_again);
    tensor.data.resize((end - begin) / sizeof(float));
    std::memcpy(tensor.data.data(), raw.bytes.data() + begin, end - begin);
    return tensor;
}

std::string make_header(const Weights& weights) {
    json header;
    header["__metadata__"] = {{"format", "fastcloth"},
                              {"version", std::to_string(ModelConfig::format_version)},
                              {"config", weights.config.to_json()}};
    std::uint64_t offset = 0;
    for (const auto& [name, tensor] : weights.tensors) {
        const std::uint64_t end = offset + tensor.data.size() * sizeof(float);
        header[name] = {{"dtype", "F32"}, {"shape", tensor.shape}, {"data_offsets", {offset, end}}};
        offset = end;
    }
    std::string text = header.dump();
    text.resize((text.size() + 7) / 8 * 8, ' ');  // the format asks for aligned numbers
    return text;
}

}  // namespace

Weights Weights::load(const std::string& file) {
    const RawFile raw = read_raw(file);
    if (metadata(raw, file, "format") != "fastcloth")
        throw LoadError(file, "header, format", "is not fastcloth",
                        "use a weights file written by this project");
    const std::string version = metadata(raw, file, "version");
    if (version != std::to_string(ModelConfig::format_version))
        throw LoadError(file, "header, version",
                        "is " + printable(version) + " where this program reads " +
                            std::to_string(ModelConfig::format_version),
                        train_again);
    Weights weights;
    weights.called = std::filesystem::path(file).stem().string();
    weights.config = ModelConfig::from_json(metadata(raw, file, "config"), file);
    for (const auto& [name, entry] : raw.header.items())
        if (name != "__metadata__")
            weights.tensors[name] = read_tensor(raw, entry, "tensor " + printable(name), file);
    const Problem problem = find_problem(weights.config, weights.tensors);
    if (!problem.place.empty()) throw LoadError(file, problem.place, problem.text, train_again);
    return weights;
}

void Weights::save(const std::string& file) const {
    const Problem problem = find_problem(config, tensors);
    if (!problem.place.empty())
        throw ArgumentError(problem.place, problem.text, "save the tensors of the configuration");
    const std::string header = make_header(*this), temporary = file + ".tmp";
    std::ofstream out(temporary, std::ios::binary);
    const std::uint64_t length = header.size();
    out.write(reinterpret_cast<const char*>(&length), sizeof length);
    out.write(header.data(), static_cast<std::streamsize>(header.size()));
    for (const auto& [name, tensor] : tensors)
        out.write(reinterpret_cast<const char*>(tensor.data.data()),
                  static_cast<std::streamsize>(tensor.data.size() * sizeof(float)));
    out.close();
    if (!out || std::rename(temporary.c_str(), file.c_str()) != 0)
        throw LoadError(file, "", "cannot be written", "check the folder and the free space");
}

const WeightTensor& Weights::tensor(const std::string& name) const {
    const auto found = tensors.find(name);
    if (found == tensors.end())
        throw ArgumentError("tensor " + name, "is not part of this network",
                            "see parameter_shapes() for the names");
    return found->second;
}

}  // namespace cloth
