#include "data/files/painted_mesh.h"

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

#include "data/core/errors.h"
#include "data/files/painted_places.h"
#include "data/files/vertex_paint.h"

namespace cloth {

namespace {

constexpr size_t goal_count = 4;

std::array<const VectorX*, goal_count> arrays_of(const GoalLimits& limits) {
    return {&limits.max_distance, &limits.backstop, &limits.drive_stiffness, &limits.drive_damping};
}

std::array<VectorX*, goal_count> arrays_of(GoalLimits& limits) {
    return {&limits.max_distance, &limits.backstop, &limits.drive_stiffness, &limits.drive_damping};
}

template <typename Number>
void append_little_endian(std::string& bytes, Number number) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof number);
    for (size_t k = 0; k < sizeof number; ++k) bytes += static_cast<char>(bits >> (8 * k) & 0xff);
}

std::string ply_of(const TriMesh& mesh, const GoalLimits& limits) {
    std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                        std::to_string(mesh.vertices.rows()) +
                        "\nproperty double x\nproperty double y\nproperty double z\n";
    const auto arrays = arrays_of(limits);
    for (size_t k = 0; k < goal_count; ++k)
        if (arrays[k]->size() > 0) bytes += "property double " + goal_names()[k] + "\n";
    bytes += "element face " + std::to_string(mesh.faces.rows()) +
             "\nproperty list uchar int vertex_indices\nend_header\n";
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i) {
        for (int c = 0; c < 3; ++c) append_little_endian(bytes, mesh.vertices(i, c));
        for (const VectorX* const values : arrays)
            if (values->size() > 0) append_little_endian(bytes, (*values)[i]);
    }
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
        bytes += '\3';
        for (int c = 0; c < 3; ++c)
            append_little_endian(bytes, static_cast<std::int32_t>(mesh.faces(f, c)));
    }
    return bytes;
}

}  // namespace

PaintedMesh load_painted_mesh(const std::string& path, const std::string& mesh_name,
                              FacesWithoutArea without_area,
                              const std::optional<GoalColours>& colours) {
    VertexPaint paint(colours);
    PaintedMesh painted;
    painted.mesh = load_mesh(path, mesh_name, without_area, &paint);
    painted.limits = paint.limits(painted.mesh.vertices.rows());
    painted.unread_colours = paint.has_unread_colours();
    return painted;
}

GoalLimits welded_limits(const GoalLimits& limits, const WeldedMesh& welded) {
    check(limits, static_cast<Eigen::Index>(welded.target.size()), "welded_limits()");
    std::vector<int> number(welded.target.size(), -1);
    for (size_t i = 0; i < welded.kept.size(); ++i)
        number[static_cast<size_t>(welded.kept[i])] = static_cast<int>(i);
    const auto from = arrays_of(limits);
    GoalLimits result;
    const auto to = arrays_of(result);
    std::vector<PaintedVertex> joined(welded.kept.size());
    for (size_t i = 0; i < welded.target.size(); ++i) {
        const int into = number[static_cast<size_t>(welded.target[i])];
        if (into < 0) continue;  // of no face
        PaintedVertex painted;
        for (size_t k = 0; k < goal_count; ++k)
            if (from[k]->size() > 0) painted.values[k] = (*from[k])[static_cast<Eigen::Index>(i)];
        joined[static_cast<size_t>(into)].tighten(painted);
    }
    for (size_t k = 0; k < goal_count; ++k) {
        if (from[k]->size() == 0) continue;
        to[k]->resize(static_cast<Eigen::Index>(joined.size()));
        for (size_t i = 0; i < joined.size(); ++i)
            (*to[k])[static_cast<Eigen::Index>(i)] = joined[i].values[k];
    }
    return result;
}

void save_painted_ply(const std::string& path, const TriMesh& mesh, const GoalLimits& limits) {
    check(limits, mesh.vertices.rows(), "save_painted_ply()");
    const std::string temporary = path + ".tmp", bytes = ply_of(mesh, limits);
    std::FILE* const file = std::fopen(temporary.c_str(), "wb");
    bool written = file && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    if (file) written = std::fclose(file) == 0 && written;
    std::error_code error;
    if (written) std::filesystem::rename(temporary, path, error);
    if (written && !error) return;
    std::error_code none;
    std::filesystem::remove(temporary, none);
    throw LoadError(path, "", "cannot be written",
                    "check that the folder exists, may be written to and has space");
}

}  // namespace cloth
