#include "data/files/mhclo.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <map>
#include <sstream>

#include "data/core/errors.h"
#include "data/core/printable.h"
#include "data/core/read_file.h"
#include "data/files/mesh_io.h"

namespace cloth {

namespace {

namespace fs = std::filesystem;

constexpr int most_vertices = 10000000;  // that a base mesh may have

bool finite_number(const std::string& word, double& number) {
    char* end = nullptr;
    number = std::strtod(word.c_str(), &end);
    return end != word.c_str() && *end == '\0' && std::isfinite(number);
}

bool vertex_number(const std::string& word, int& vertex) {
    double number = 0.0;
    if (!finite_number(word, number) || number != std::floor(number)) return false;
    if (number < 0 || number >= most_vertices) return false;
    vertex = static_cast<int>(number);
    return true;
}

std::vector<std::string> words_of(const std::string& line) {
    std::istringstream split(line.substr(0, line.find('#')));
    return {std::istream_iterator<std::string>(split), {}};
}

bool parse_row(const std::vector<std::string>& words, MhcloRow& row) {
    if (words.size() == 1) return vertex_number(words[0], row.vertices[0]);
    if (words.size() != 9) return false;
    for (size_t k = 0; k < 3; ++k) {
        const auto axis = static_cast<Eigen::Index>(k);
        if (!vertex_number(words[k], row.vertices[k]) ||
            !finite_number(words[3 + k], row.weights[axis]) ||
            !finite_number(words[6 + k], row.offset[axis]))
            return false;
    }
    return true;
}

bool parse_scale(const std::vector<std::string>& words, MhcloFile::Scale& scale) {
    return words.size() == 4 && vertex_number(words[1], scale.from) &&
           vertex_number(words[2], scale.to) && finite_number(words[3], scale.distance) &&
           scale.distance > 0.0;
}

/// A line with a key. @return false if it is malformed
bool parse_key(const std::vector<std::string>& words, MhcloFile& file) {
    const std::string& key = words[0];
    if (key == "x_scale") return parse_scale(words, file.scales[0]);
    if (key == "y_scale") return parse_scale(words, file.scales[1]);
    if (key == "z_scale") return parse_scale(words, file.scales[2]);
    if (key == "name" && words.size() > 1) file.name = printable(words[1]);
    if (key != "obj_file") return true;
    if (words.size() != 2 || words[1].find('/') != std::string::npos) return false;
    file.obj_file = (fs::path(file.path).parent_path() / printable(words[1])).string();
    return true;
}

/// The places of an OBJ file's vertices, as they are numbered there, by their bits.
std::map<std::array<double, 3>, int> obj_vertices(const std::string& path, int& count) {
    std::istringstream text(read_file(path));
    std::map<std::array<double, 3>, int> vertices;
    count = 0;
    for (std::string line; std::getline(text, line);) {
        const std::vector<std::string> words = words_of(line);
        if (words.size() < 4 || words[0] != "v") continue;
        std::array<double, 3> place{};
        for (size_t k = 0; k < 3; ++k)
            if (!finite_number(words[k + 1], place[k]))
                throw LoadError(path, "vertex " + std::to_string(count), "is malformed",
                                "copy the file again");
        for (double& x : place) x += 0.0;  // -0 and 0 are one place
        vertices.emplace(place, count++);
    }
    return vertices;
}

}  // namespace

int MhcloFile::highest_vertex() const {
    int highest = 0;
    for (const MhcloRow& row : rows)
        highest = std::max(highest, *std::max_element(row.vertices.begin(), row.vertices.end()));
    for (const Scale& scale : scales) highest = std::max({highest, scale.from, scale.to});
    return highest;
}

Points MhcloFile::places(const Points& base) const {
    if (highest_vertex() >= base.rows())
        throw ArgumentError(path,
                            "it names vertex " + std::to_string(highest_vertex()) +
                                ", the base mesh has " + std::to_string(base.rows()),
                            "use the base mesh hm08 with its helpers");
    Vec3 scale = Vec3::Ones();
    for (int k = 0; k < 3; ++k) {
        const Scale& axis = scales[static_cast<size_t>(k)];
        if (axis.from >= 0)
            scale[k] = std::abs(base(axis.from, k) - base(axis.to, k)) / axis.distance;
    }
    Points result(static_cast<Eigen::Index>(rows.size()), 3);
    for (Eigen::Index i = 0; i < result.rows(); ++i) {
        const MhcloRow& row = rows[static_cast<size_t>(i)];
        Vec3 place = row.offset.cwiseProduct(scale);
        for (size_t k = 0; k < 3; ++k)
            place +=
                row.weights[static_cast<Eigen::Index>(k)] * base.row(row.vertices[k]).transpose();
        result.row(i) = place.transpose();
        if (!place.allFinite())
            throw ArgumentError(
                path, "row " + std::to_string(i) + " leads nowhere: its place is not finite",
                "copy the file again");
    }
    return result;
}

MhcloFile load_mhclo(const std::string& path) {
    MhcloFile file;
    file.path = path;
    file.name = fs::path(path).stem().string();
    std::istringstream text(read_file(path));
    enum class Part { head, rows, tail } part = Part::head;
    std::string line;
    for (int number = 1; std::getline(text, line); ++number) {
        const std::vector<std::string> words = words_of(line);
        if (words.empty()) continue;
        const char first = words[0][0];
        const bool has_number = (first >= '0' && first <= '9') || first == '-';
        if (part == Part::rows && !has_number) part = Part::tail;
        bool good = true;
        if (part == Part::rows) {
            file.rows.emplace_back();
            good = parse_row(words, file.rows.back());
        } else if (words[0] == "verts" && file.rows.empty()) {
            part = Part::rows;
        } else if (!has_number) {
            good = parse_key(words, file);
        }
        if (!good)
            throw LoadError(path, "line " + std::to_string(number), "is malformed",
                            "copy the file again; a row is 'a b c wa wb wc dx dy dz' or 'a', a "
                            "scale 'x_scale A B D' with D above 0");
    }
    if (file.obj_file.empty())
        throw LoadError(path, "", "it names no OBJ file", "give a line 'obj_file NAME'");
    if (file.rows.empty())
        throw LoadError(path, "", "it has no rows of vertices",
                        "give a whole file of MakeHuman's clothes");
    return file;
}

TriMesh load_mhclo_mesh(const MhcloFile& file, const Points& base) {
    const Points places = file.places(base);
    TriMesh mesh = load_mesh(file.obj_file, "", FacesWithoutArea::keep);
    int count = 0;
    const std::map<std::array<double, 3>, int> numbers = obj_vertices(file.obj_file, count);
    if (count != static_cast<int>(file.rows.size()))
        throw LoadError(file.obj_file, "",
                        "it has " + std::to_string(count) + " vertices, " + file.path + " " +
                            std::to_string(file.rows.size()) + " rows",
                        "take both files from one folder");
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i) {
        const auto found = numbers.find(
            {mesh.vertices(i, 0) + 0.0, mesh.vertices(i, 1) + 0.0, mesh.vertices(i, 2) + 0.0});
        if (found == numbers.end())
            throw LoadError(file.obj_file, "", "its vertices cannot be told apart",
                            "export it again as plain OBJ");
        mesh.vertices.row(i) = places.row(found->second);
    }
    return mesh;
}

}  // namespace cloth
