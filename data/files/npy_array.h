#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cloth {

/// An array of a NumPy file: numbers in the order of C (the last index runs fastest), whatever
/// order the file has, or one line of text.
struct NpyArray {
    std::vector<std::int64_t> shape;  ///< empty: a single value
    std::vector<double> numbers;      ///< empty if it is text
    std::string text;                 ///< of '<U' (those of its characters that are ASCII) or '|S'
    bool is_text = false;

    std::int64_t size() const;  ///< number of elements
};

/// Reads what a .npy file holds: bool, integers of 1 to 8 bytes, float32, float64, in either byte
/// order, or a single text. Integers beyond 2^53 are rounded.
/// @param file, place  for errors: file, and array in it
/// @throws LoadError if the bytes are cut off or no .npy, or of another type. Arrays of Python
///         objects, which NumPy pickles, are refused: they could run any program
NpyArray parse_npy(const std::string& bytes, const std::string& file, const std::string& place);

/// @throws LoadError also if the file cannot be read
NpyArray load_npy(const std::string& path);

}  // namespace cloth
