#include "demos/compare/trajectory.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "data/core/errors.h"

namespace cloth {
namespace {

constexpr char magic[8] = {'C', 'L', 'O', 'T', 'H', 'T', 'R', '1'};

struct Header {
    char magic_bytes[8];
    std::uint64_t states;
    std::uint64_t vertices;
};

std::streamsize bytes_of(const Points& points) {
    return static_cast<std::streamsize>(points.size() * static_cast<Eigen::Index>(sizeof(double)));
}

}  // namespace

void save_trajectory(const std::string& path, const Trajectory& trajectory) {
    const std::string temporary = path + ".tmp";
    std::ofstream file(temporary, std::ios::binary);
    Header header{};
    std::copy(std::begin(magic), std::end(magic), header.magic_bytes);
    header.states = trajectory.size();
    header.vertices =
        trajectory.empty() ? 0 : static_cast<std::uint64_t>(trajectory.front().x.rows());
    file.write(reinterpret_cast<const char*>(&header), sizeof(header));
    for (const ClothState& state : trajectory) {
        file.write(reinterpret_cast<const char*>(&state.time), sizeof(double));
        file.write(reinterpret_cast<const char*>(state.x.data()), bytes_of(state.x));
        file.write(reinterpret_cast<const char*>(state.v.data()), bytes_of(state.v));
    }
    file.close();
    if (!file || std::rename(temporary.c_str(), path.c_str()) != 0)
        throw LoadError(path, "", "cannot be written", "check free space and permissions");
}

Trajectory load_trajectory(const std::string& path) {
    const std::string remedy = "delete it; it is computed again";
    std::ifstream file(path, std::ios::binary);
    if (!file) throw LoadError(path, "", "cannot be opened", "run the comparison from the start");
    Header header{};
    file.read(reinterpret_cast<char*>(&header), sizeof(header));
    if (!file || !std::equal(std::begin(magic), std::end(magic), header.magic_bytes))
        throw LoadError(path, "header", "is not a trajectory", remedy);
    const std::uint64_t size = std::filesystem::file_size(path);
    const std::uint64_t state_bytes = sizeof(double) * (1 + 6 * header.vertices);
    const bool overflows = header.vertices > size || header.states > size;
    if (overflows || size != sizeof(header) + header.states * state_bytes)
        throw LoadError(path, "header", "does not fit the file's size", remedy);
    Trajectory trajectory(header.states);
    for (ClothState& state : trajectory) {
        state.x.resize(static_cast<Eigen::Index>(header.vertices), 3);
        state.v.resize(static_cast<Eigen::Index>(header.vertices), 3);
        file.read(reinterpret_cast<char*>(&state.time), sizeof(double));
        file.read(reinterpret_cast<char*>(state.x.data()), bytes_of(state.x));
        file.read(reinterpret_cast<char*>(state.v.data()), bytes_of(state.v));
    }
    if (!file) throw LoadError(path, "", "is truncated", remedy);
    return trajectory;
}

double rmse_mm(const Points& a, const Points& b) {
    return 1e3 * std::sqrt((a - b).rowwise().squaredNorm().mean());
}

}  // namespace cloth
