// MakeHuman's shape model: v = base + sum of weight x target, every target relative to the base.
// The weights of the macro targets are products of factors (sex, descent, muscle, weight, height),
// where a factor x in [0, 1] is split into min = max(0, 1 - 2x), max = max(0, 2x - 1) and average,
// the rest. See the data's own notes: at the defaults this gives Debian's human.zae to 0.5 mm.

#include "data/body/body_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <random>
#include <sstream>

#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/core/read_file.h"

namespace cloth {

namespace {

namespace fs = std::filesystem;

constexpr double metres_per_unit = 0.1;
constexpr int skin_vertex_count = 13380;
constexpr const char* levels[] = {"min", "average", "max"};

std::array<double, 3> split_factor(double x) {
    const double low = std::max(0.0, 1.0 - 2.0 * x);
    const double high = std::max(0.0, 2.0 * x - 1.0);
    return {low, 1.0 - low - high, high};
}

Points load_base_vertices(const std::string& path) {
    std::istringstream file(read_file(path));
    std::vector<Vec3> vertices;
    std::string line, key;
    while (std::getline(file, line)) {
        std::istringstream words(line);
        Vec3 v;
        if (!(words >> key) || key != "v") continue;
        if (!(words >> v.x() >> v.y() >> v.z()))
            throw LoadError(path, "vertex " + std::to_string(vertices.size()), "is malformed",
                            "copy the file again");
        vertices.push_back(v);
    }
    if (vertices.size() < skin_vertex_count)
        throw LoadError(path, "", "holds fewer vertices than a body's skin has",
                        "use MakeHuman's base mesh hm08");
    Points points(static_cast<Eigen::Index>(vertices.size()), 3);
    for (Eigen::Index i = 0; i < points.rows(); ++i) points.row(i) = vertices[i];
    return points;
}

/// False unless all words are finite numbers (".5" is one).
bool parse_numbers(const std::vector<std::string>& words, std::array<double, 4>& numbers) {
    for (size_t i = 0; i < numbers.size(); ++i) {
        char* end = nullptr;
        numbers[i] = std::strtod(words[i].c_str(), &end);
        if (*end != '\0' || end == words[i].c_str() || !std::isfinite(numbers[i])) return false;
    }
    return true;
}

/// Uniform numbers from the raw bits of the generator: the distributions of the standard library
/// differ between implementations.
class Uniform {
 public:
    explicit Uniform(uint64_t seed) : m_bits(seed) {}
    double operator()(double low, double high) {
        return low + (high - low) * static_cast<double>(m_bits() >> 11) * 0x1p-53;
    }

 private:
    std::mt19937_64 m_bits;
};

}  // namespace

BodyShape sample_body_shape(uint64_t seed) {
    Uniform uniform(seed);
    BodyShape shape;
    shape.female = uniform(0.0, 1.0);
    shape.height = 0.5 + 0.5 * (uniform(-0.1, 0.1) + uniform(-0.1, 0.1));
    shape.weight = uniform(0.2, 0.8);
    shape.muscle = uniform(0.3, 0.7);
    // Two sorted cuts of [0, 1]: uniform over all mixtures of three.
    const double a = uniform(0.0, 1.0), b = uniform(0.0, 1.0);
    shape.african = std::min(a, b);
    shape.asian = std::abs(a - b);
    for (double* slider : {&shape.bust, &shape.waist, &shape.hips, &shape.shoulders, &shape.limbs})
        *slider = uniform(-0.5, 0.5);
    return shape;
}

ShapeTarget load_shape_target(const std::string& path, int vertex_count) {
    std::istringstream file(read_file(path));
    ShapeTarget target;
    std::vector<Vec3> offsets;
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        line.resize(std::min(line.find('#'), line.size()));
        std::istringstream split(line);
        const std::vector<std::string> words(std::istream_iterator<std::string>(split), {});
        if (words.empty()) continue;
        std::array<double, 4> row{};
        const bool complete = words.size() == 4 && parse_numbers(words, row);
        const double vertex = row[0];
        if (!complete || vertex != std::floor(vertex) || vertex < 0 || vertex >= vertex_count)
            throw LoadError(
                path, "line " + std::to_string(number),
                "is not 'index dx dy dz' with an index below " + std::to_string(vertex_count),
                "copy the file again; targets belong to one base mesh");
        target.vertices.push_back(static_cast<int>(vertex));
        offsets.emplace_back(row[1], row[2], row[3]);
    }
    target.offsets.resize(static_cast<Eigen::Index>(offsets.size()), 3);
    for (size_t i = 0; i < offsets.size(); ++i)
        target.offsets.row(static_cast<Eigen::Index>(i)) = offsets[i];
    return target;
}

BodyShapes::BodyShapes(const std::string& folder)
    : m_base(load_base_vertices((fs::path(folder) / "base.obj").string())) {
    const fs::path root = fs::path(folder) / "targets";
    if (!fs::is_directory(root))
        throw LoadError(root.string(), "", "is not a folder", "restore the shared data folder");
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root))
        if (entry.path().extension() == ".target") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) {
        const std::string name = fs::relative(file, root).replace_extension().generic_string();
        m_targets.push_back(
            {name, load_shape_target(file.string(), static_cast<int>(m_base.rows()))});
    }
}

std::optional<BodyShapes> BodyShapes::load_shared() {
    const auto folder = shared_data_path("body_makehuman");
    if (!folder) return std::nullopt;
    return BodyShapes(*folder);
}

void BodyShapes::add(Points& points, const std::string& name, double weight) const {
    if (weight == 0.0) return;
    const auto found = std::find_if(m_targets.begin(), m_targets.end(),
                                    [&](const NamedTarget& t) { return t.name == name; });
    if (found == m_targets.end())
        throw LoadError(name + ".target", "", "is missing", "restore the shared data folder");
    const ShapeTarget& target = found->target;
    for (size_t k = 0; k < target.vertices.size(); ++k)
        points.row(target.vertices[k]) += weight * target.offsets.row(static_cast<Eigen::Index>(k));
}

void BodyShapes::add_slider(Points& points, const std::string& name, double value) const {
    add(points, name + "-incr", std::max(0.0, value));
    add(points, name + "-decr", std::max(0.0, -value));
}

void BodyShapes::add_descent(Points& points, const BodyShape& shape) const {
    const std::pair<const char*, double> descents[] = {
        {"african", shape.african},
        {"asian", shape.asian},
        {"caucasian", 1.0 - shape.african - shape.asian}};
    for (const auto& [descent, share] : descents)
        for (const auto& [sex, part] :
             {std::pair("female", shape.female), std::pair("male", 1.0 - shape.female)})
            add(points, std::string("macrodetails/") + descent + "-" + sex + "-young",
                share * part);
}

void BodyShapes::add_build(Points& points, const BodyShape& shape) const {
    const std::array<double, 3> muscle = split_factor(shape.muscle);
    const std::array<double, 3> weight = split_factor(shape.weight);
    const std::array<double, 3> height = split_factor(shape.height);
    for (const auto& [sex, part] :
         {std::pair("female", shape.female), std::pair("male", 1.0 - shape.female)}) {
        for (int m = 0; m < 3; ++m)
            for (int w = 0; w < 3; ++w)
                add(points,
                    std::string("macrodetails/universal-") + sex + "-young-" + levels[m] +
                        "muscle-" + levels[w] + "weight",
                    part * muscle[m] * weight[w]);
        for (int h : {0, 2})
            add(points,
                std::string("macrodetails/height/") + sex + "-young-averagemuscle-averageweight-" +
                    levels[h] + "height",
                part * height[h]);
    }
}

Points BodyShapes::base_mesh(const BodyShape& shape) const {
    Points points = m_base;
    add_descent(points, shape);
    add_build(points, shape);
    add_slider(points, "measure/measure-bust-circ", shape.bust);
    add_slider(points, "measure/measure-waist-circ", shape.waist);
    add_slider(points, "measure/measure-hips-circ", shape.hips);
    add_slider(points, "measure/measure-shoulder-dist", shape.shoulders);
    add_slider(points, "measure/measure-thigh-circ", shape.limbs);
    add_slider(points, "measure/measure-calf-circ", shape.limbs);
    add_slider(points, "measure/measure-upperarm-circ", shape.limbs);
    points *= metres_per_unit;
    points.col(1).array() -= points.col(1).head(skin_vertex_count).minCoeff();
    return points;
}

Points BodyShapes::skin(const BodyShape& shape) const {
    return base_mesh(shape).topRows(skin_vertex_count);
}

}  // namespace cloth
