#include "gnn/model/tensor_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "data/core/errors.h"
#include "data/core/printable.h"
#include "data/core/read_file.h"
#include "data/files/json_integers.h"

namespace cloth {

using nlohmann::json;

namespace {

const char* const export_again = "train or export the network again";

size_t element_count(const std::vector<int>& shape) {
    size_t count = 1;
    for (int size : shape) count *= static_cast<size_t>(size);
    return count;
}

std::string to_text(const std::vector<int>& shape) {
    return json(shape).dump();
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
        throw LoadError(file, "header", "the file is truncated", export_again);
    std::memcpy(&length, all.data(), sizeof length);
    if (length > all.size() - sizeof length)
        throw LoadError(file, "header", "the file is truncated or not in safetensors format",
                        export_again);
    const auto begin = all.begin() + sizeof length;
    const auto end = begin + static_cast<std::ptrdiff_t>(length);
    RawFile raw{json::parse(begin, end, nullptr, false), {end, all.end()}};
    if (!raw.header.is_object())
        throw LoadError(file, "header", "is not a JSON object", export_again);
    return raw;
}

/// Bytes [begin, end) behind the header that a tensor takes.
struct Place {
    std::uint64_t begin, end;
    std::string name;
};

WeightTensor read_tensor(const RawFile& raw, const json& entry, const std::string& place,
                         const std::string& file, std::vector<Place>& used) {
    WeightTensor tensor;
    std::uint64_t begin = 0, end = 0;
    try {
        if (entry.at("dtype") != "F32")
            throw LoadError(file, place, "is not of type F32", "store float32 numbers");
        read_integer(entry.at("shape"), "shape", tensor.shape);
        read_integer(entry.at("data_offsets").at(0), "data_offsets", begin);
        read_integer(entry.at("data_offsets").at(1), "data_offsets", end);
    } catch (const json::exception& error) {
        throw LoadError(file, place, error.what(), export_again);
    } catch (const ArgumentError& error) {
        throw LoadError(file, place, error.what(), export_again);
    }
    for (int size : tensor.shape)
        if (size < 1 || size > (1 << 20))
            throw LoadError(file, place, "has an unusable shape", export_again);
    if (begin > end || end > raw.bytes.size())
        throw LoadError(file, place, "lies outside the file: it is truncated", export_again);
    if ((end - begin) != element_count(tensor.shape) * sizeof(float))
        throw LoadError(file, place, "has a size that does not fit its shape", export_again);
    tensor.data.resize((end - begin) / sizeof(float));
    std::memcpy(tensor.data.data(), raw.bytes.data() + begin, end - begin);
    used.push_back({begin, end, place});
    return tensor;
}

/// The format asks for tensors one behind the other, to the end of the file: what lies between them
/// or in two of them was written wrongly.
void check_places(std::vector<Place> used, size_t bytes, const std::string& file) {
    std::sort(used.begin(), used.end(),
              [](const Place& a, const Place& b) { return a.begin < b.begin; });
    std::uint64_t end = 0;
    for (const Place& place : used) {
        if (place.begin != end)
            throw LoadError(file, place.name,
                            place.begin < end ? "shares bytes with another tensor"
                                              : "does not begin where the one before it ends",
                            export_again);
        end = place.end;
    }
    if (end != bytes)
        throw LoadError(file, "",
                        "has " + std::to_string(bytes - end) + " bytes behind its last tensor",
                        export_again);
}

std::string make_header(const TensorFile& file) {
    json header;
    header["__metadata__"] = file.metadata;
    std::uint64_t offset = 0;
    for (const auto& [name, tensor] : file.tensors) {
        const std::uint64_t end = offset + tensor.data.size() * sizeof(float);
        header[name] = {{"dtype", "F32"}, {"shape", tensor.shape}, {"data_offsets", {offset, end}}};
        offset = end;
    }
    std::string text = header.dump();
    text.resize((text.size() + 7) / 8 * 8, ' ');  // the format asks for aligned numbers
    return text;
}

}  // namespace

TensorFile TensorFile::load(const std::string& file) {
    const RawFile raw = read_raw(file);
    TensorFile loaded;
    std::vector<Place> used;
    for (const auto& [name, entry] : raw.header.items()) {
        if (name != "__metadata__") {
            loaded.tensors[name] = read_tensor(raw, entry, "tensor " + printable(name), file, used);
            continue;
        }
        if (!entry.is_object()) continue;
        for (const auto& [key, value] : entry.items())
            if (value.is_string()) loaded.metadata[key] = value.get<std::string>();
    }
    check_places(std::move(used), raw.bytes.size(), file);
    return loaded;
}

const std::string& TensorFile::entry(const std::string& key, const std::string& file) const {
    const auto found = metadata.find(key);
    if (found == metadata.end())
        throw LoadError(file, "header, __metadata__." + key, "is missing",
                        "use a weights file written by this project");
    return found->second;
}

void TensorFile::save(const std::string& file) const {
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

TensorProblem find_problem(const std::vector<TensorShape>& shapes,
                           const std::map<std::string, WeightTensor>& tensors) {
    for (const auto& [name, shape] : shapes) {
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
    if (tensors.size() == shapes.size()) return {};
    std::set<std::string> known;
    for (const TensorShape& shape : shapes) known.insert(shape.first);
    for (const auto& [name, tensor] : tensors)
        if (known.count(name) == 0)
            return {"tensor " + printable(name), "is not one of the configuration"};
    return {};
}

TensorProblem find_bad_divisor(const std::string& name, const WeightTensor& tensor) {
    for (size_t i = 0; i < tensor.data.size(); ++i)
        if (!(tensor.data[i] > 0.0f && std::isfinite(1.0f / tensor.data[i])))
            return {"tensor " + name, "element " + std::to_string(i) + " is not positive"};
    return {};
}

}  // namespace cloth
