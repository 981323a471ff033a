#pragma once

#include <map>
#include <string>
#include <vector>

#include "data/files/npy_array.h"

namespace cloth {

/// A file of NumPy arrays with names (.npz, as numpy.savez and numpy.savez_compressed write it): a
/// zip archive with a .npy for each. Arrays are read when they are asked for, so those that nobody
/// needs may be of any type.
///
///     const NpzFile file("motion.npz");
///     const NpyArray poses = file.numbers("poses", /*axes=*/2);
class NpzFile {
 public:
    /// @throws LoadError if there is no such file, or it is no zip archive
    explicit NpzFile(const std::string& path);

    const std::string& path() const { return m_path; }
    bool has(const std::string& name) const { return m_places.count(name) > 0; }
    std::vector<std::string> names() const;

    /// @throws LoadError naming file and array if there is none, its bytes are damaged, or as
    ///         parse_npy() does
    NpyArray array(const std::string& name) const;

    /// Numbers, all of them finite, of so many axes.
    NpyArray numbers(const std::string& name, size_t axes) const;
    /// A single number.
    double number(const std::string& name) const;
    /// A single text.
    std::string text(const std::string& name) const;

    /// For what is wrong with an array. @throws LoadError always
    [[noreturn]] void fail(const std::string& name, const std::string& problem,
                           const std::string& remedy) const;

 private:
    std::string m_path;
    std::map<std::string, unsigned long> m_places;  ///< number of each array in the archive
};

}  // namespace cloth
