#include "data/files/npz_file.h"

#include <unzip.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "data/core/errors.h"
#include "data/core/printable.h"
#include "data/core/read_file.h"

namespace cloth {

namespace {

using NpzArchive = std::unique_ptr<void, int (*)(void*)>;

NpzArchive open_archive(const std::string& path) {
    return {unzOpen64(path.c_str()), unzClose};
}

const char* const ask = "numpy.load lists what a file holds";

}  // namespace

NpzFile::NpzFile(const std::string& path) : m_path(path) {
    const NpzArchive archive = open_archive(path);
    if (!archive) {
        read_file(path);  // says that there is no such file, or that it is a folder
        throw LoadError(path, "", "is not an .npz file", "write it with numpy.savez");
    }
    unsigned long place = 0;
    for (int found = unzGoToFirstFile(archive.get()); found == UNZ_OK;
         found = unzGoToNextFile(archive.get()), ++place) {
        char name[512] = "";
        unz_file_info64 info;
        if (unzGetCurrentFileInfo64(archive.get(), &info, name, sizeof name - 1, nullptr, 0,
                                    nullptr, 0) != UNZ_OK)
            break;
        const std::string whole = name, ending = ".npy";
        if (whole.size() > ending.size() &&
            whole.compare(whole.size() - ending.size(), ending.size(), ending) == 0)
            m_places.emplace(whole.substr(0, whole.size() - ending.size()), place);
    }
    if (m_places.empty()) throw LoadError(path, "", "holds no array", "write it with numpy.savez");
}

std::vector<std::string> NpzFile::names() const {
    std::vector<std::string> names;
    for (const auto& [name, place] : m_places) names.push_back(name);
    return names;
}

void NpzFile::fail(const std::string& name, const std::string& problem,
                   const std::string& remedy) const {
    throw LoadError(m_path, "array " + printable(name), problem, remedy);
}

NpyArray NpzFile::array(const std::string& name) const {
    const auto found = m_places.find(name);
    if (found == m_places.end()) fail(name, "is missing", ask);
    const NpzArchive archive = open_archive(m_path);
    int state = archive ? unzGoToFirstFile(archive.get()) : UNZ_BADZIPFILE;
    for (unsigned long k = 0; k < found->second && state == UNZ_OK; ++k)
        state = unzGoToNextFile(archive.get());
    if (state == UNZ_OK) state = unzOpenCurrentFile(archive.get());
    if (state != UNZ_OK) fail(name, "cannot be unpacked", "download or save the file again");
    std::string bytes, part(1 << 16, '\0');
    int n = 0;
    while ((n = unzReadCurrentFile(archive.get(), part.data(),
                                   static_cast<unsigned>(part.size()))) > 0)
        bytes.append(part.data(), static_cast<size_t>(n));
    if (unzCloseCurrentFile(archive.get()) != UNZ_OK || n < 0)
        fail(name, "is damaged: its check sum does not fit", "download or save the file again");
    return parse_npy(bytes, m_path, "array " + printable(name));
}

NpyArray NpzFile::numbers(const std::string& name, size_t axes) const {
    NpyArray array = this->array(name);
    if (array.is_text || array.shape.size() != axes)
        fail(name,
             array.is_text ? "is a text, where numbers are expected"
                           : "has " + std::to_string(array.shape.size()) + " axes, where " +
                                 std::to_string(axes) + " are expected",
             ask);
    if (!std::all_of(array.numbers.begin(), array.numbers.end(),
                     [](double number) { return std::isfinite(number); }))
        fail(name, "holds a number that is not finite", "write finite numbers");
    return array;
}

double NpzFile::number(const std::string& name) const {
    const NpyArray array = this->array(name);
    if (array.is_text || array.numbers.size() != 1 || !std::isfinite(array.numbers[0]))
        fail(name, "is not a single number", ask);
    return array.numbers[0];
}

std::string NpzFile::text(const std::string& name) const {
    const NpyArray array = this->array(name);
    if (!array.is_text) fail(name, "is not a text", ask);
    return array.text;
}

}  // namespace cloth
