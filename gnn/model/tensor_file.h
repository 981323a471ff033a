#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace cloth {

/// Name and shape of one array of numbers of a network.
using TensorShape = std::pair<std::string, std::vector<int>>;

/// One array of numbers, row major.
struct WeightTensor {
    std::vector<int> shape;
    std::vector<float> data;
};

/// Arrays of numbers with names, and what they are of, as a file: safetensors, that is 8 bytes of
/// header length, a JSON header, then the numbers (little-endian float32). `metadata` stands in the
/// header's __metadata__, so that any safetensors reader can open the file.
struct TensorFile {
    std::map<std::string, std::string> metadata;
    std::map<std::string, WeightTensor> tensors;

    /// @throws LoadError naming file, place and reason: truncated, no safetensors, an array of
    ///         another type than F32, one that does not fit its shape, or bytes that belong to two
    ///         arrays or to none
    static TensorFile load(const std::string& file);

    /// An entry of the metadata. @throws LoadError if there is none. @param file  named in errors
    const std::string& entry(const std::string& key, const std::string& file) const;

    /// Writes a temporary file and renames it, so readers never see half a file.
    /// @throws LoadError if it cannot be written
    void save(const std::string& file) const;
};

/// What is wrong with a set of tensors; empty place: nothing.
struct TensorProblem {
    std::string place, text;
};

/// Whether the tensors are those of the shapes, no more and no fewer, all of their numbers finite.
TensorProblem find_problem(const std::vector<TensorShape>& shapes,
                           const std::map<std::string, WeightTensor>& tensors);

/// Whether features can be divided by all numbers of the tensor called `name`.
TensorProblem find_bad_divisor(const std::string& name, const WeightTensor& tensor);

}  // namespace cloth
