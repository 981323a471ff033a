#include "data/authoring/sheet.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "data/authoring/mesh_quality.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using Delaunay =
    CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase>>;
using Vec2 = Eigen::Vector2d;

constexpr double kGoodSheetAngle = 26.0;  // degrees at which the smoothing stops
constexpr int kMaxRounds = 400;
constexpr int kShakeEvery = 20;  // rounds: smoothing alone can come to rest at a bad triangle

/// Numbers from 0 to 1, the same on every platform.
class Random {
 public:
    explicit Random(unsigned seed) : m_engine(seed) {}
    double operator()() { return static_cast<double>(m_engine() >> 11) * 0x1p-53; }

 private:
    std::mt19937_64 m_engine;
};

/// Points of the border first (they stay), then those of the inside.
struct PointSet {
    std::vector<Vec2> points;
    size_t border = 0;
};

/// Edge length at which `target` vertices of regular triangles fill the rectangle:
/// N = 2 A / (sqrt(3) h^2) + P / (2 h) + 1.
double edge_length(double width, double depth, int target) {
    const double a = 1.0 - target, b = width + depth, c = 2.0 / std::sqrt(3.0) * width * depth;
    return (-b - std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
}

/// Takes points that keep a distance from all that it has taken before.
class DistanceFilter {
 public:
    DistanceFilter(double width, double depth, double cell)
        : m_cell(cell),
          m_columns(static_cast<int>(width / cell) + 3),
          m_cells(static_cast<size_t>(m_columns) *
                  static_cast<size_t>(static_cast<int>(depth / cell) + 3)) {}

    /// @param distance  at most the cell
    bool take(const Vec2& p, double distance) {
        for (int i = -1; i <= 1; ++i)
            for (int j = -1; j <= 1; ++j)
                for (const Vec2& q : cell(p, i, j))
                    if ((p - q).squaredNorm() < distance * distance) return false;
        cell(p, 0, 0).push_back(p);
        return true;
    }

 private:
    std::vector<Vec2>& cell(const Vec2& p, int i, int j) {
        const int column = static_cast<int>(p.x() / m_cell) + 1 + i;
        const int row = static_cast<int>(p.y() / m_cell) + 1 + j;
        return m_cells[static_cast<size_t>(row) * static_cast<size_t>(m_columns) +
                       static_cast<size_t>(column)];
    }

    double m_cell;
    int m_columns;
    std::vector<std::vector<Vec2>> m_cells;
};

std::vector<Vec2> border_points(double width, double depth, double h) {
    const int columns = std::max(1, static_cast<int>(std::lround(width / h)));
    const int rows = std::max(1, static_cast<int>(std::lround(depth / h)));
    std::vector<Vec2> points;
    for (int i = 0; i <= columns; ++i)
        for (double z : {0.0, depth})  // the last in one line with its side, to the last bit
            points.emplace_back(i == columns ? width : width * i / columns, z);
    for (int j = 1; j < rows; ++j)
        for (double x : {0.0, width}) points.emplace_back(x, depth * j / rows);
    return points;
}

/// Random points that keep a distance, which shrinks where no more would find room.
PointSet scatter(double width, double depth, int target, Random& uniform) {
    const double h = edge_length(width, depth, target);
    PointSet set{border_points(width, depth, h), 0};
    set.border = set.points.size();
    double distance = 0.75 * h;
    DistanceFilter filter(width, depth, distance);
    for (const Vec2& p : set.points) filter.take(p, 0.0);
    const size_t count = std::max(static_cast<size_t>(target), set.border + 1);
    for (int failures = 0; set.points.size() < count;) {
        const double x = width * uniform(), z = depth * uniform();
        if (filter.take({x, z}, distance)) {
            set.points.emplace_back(x, z);
            failures = 0;
        } else if (++failures > 200) {
            distance *= 0.98;
            failures = 0;
        }
    }
    return set;
}

Faces triangulate(const std::vector<Vec2>& points) {
    std::vector<std::pair<Kernel::Point_2, int>> input;
    for (size_t i = 0; i < points.size(); ++i)
        input.push_back({{points[i].x(), points[i].y()}, static_cast<int>(i)});
    const Delaunay delaunay(input.begin(), input.end());
    Faces faces(static_cast<Eigen::Index>(delaunay.number_of_faces()), 3);
    Eigen::Index f = 0;
    for (auto face = delaunay.finite_faces_begin(); face != delaunay.finite_faces_end(); ++face) {
        // (x, z) is left-handed seen from +y: the second and third corner change places.
        faces.row(f++) << face->vertex(0)->info(), face->vertex(2)->info(), face->vertex(1)->info();
    }
    return faces;
}

/// Moves inner points to the area-weighted mean of the centroids of their triangles.
void smooth(PointSet& set, const Faces& faces) {
    std::vector<Vec2> moment(set.points.size(), Vec2::Zero());
    std::vector<double> weight(set.points.size(), 0.0);
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const Vec2 a = set.points[static_cast<size_t>(faces(f, 0))];
        const Vec2 b = set.points[static_cast<size_t>(faces(f, 1))];
        const Vec2 c = set.points[static_cast<size_t>(faces(f, 2))];
        const Vec2 u = b - a, v = c - a;
        const double area = std::abs(u.x() * v.y() - u.y() * v.x());
        for (int corner = 0; corner < 3; ++corner) {
            const size_t i = static_cast<size_t>(faces(f, corner));
            moment[i] += area * (a + b + c) / 3.0;
            weight[i] += area;
        }
    }
    for (size_t i = set.border; i < set.points.size(); ++i) set.points[i] = moment[i] / weight[i];
}

/// Moves the inner corners of bad triangles at random by up to a fifth of an edge.
void shake(PointSet& set, const TriMesh& sheet, double h, Random& uniform) {
    for (Eigen::Index f = 0; f < sheet.faces.rows(); ++f) {
        if (smallest_angle(sheet.vertices, sheet.faces.row(f)) >= kGoodSheetAngle) continue;
        for (int c = 0; c < 3; ++c) {
            const size_t i = static_cast<size_t>(sheet.faces(f, c));
            const Vec2 move(uniform() - 0.5, uniform() - 0.5);
            if (i >= set.border) set.points[i] += 0.4 * h * move;
        }
    }
}

Points lift(const std::vector<Vec2>& points, double width, double depth) {
    Points lifted(static_cast<Eigen::Index>(points.size()), 3);
    for (size_t i = 0; i < points.size(); ++i)
        lifted.row(static_cast<Eigen::Index>(i)) << points[i].x() - width / 2.0, 0.0,
            points[i].y() - depth / 2.0;
    return lifted;
}

void check_arguments(double width, double depth, int target_vertices) {
    if (!(width > 0.0 && depth > 0.0 && std::isfinite(width + depth)))
        throw ArgumentError("make_sheet: width, depth", "are not positive and finite",
                            "give sizes in metres");
    if (width > 20.0 * depth || depth > 20.0 * width)
        throw ArgumentError("make_sheet: width, depth", "the sheet is too slender",
                            "one side may be at most 20 times the other");
    if (target_vertices < 9 || target_vertices > 200000)
        throw ArgumentError("make_sheet: target_vertices",
                            std::to_string(target_vertices) + " is out of range",
                            "give 9 to 200000");
}

}  // namespace

TriMesh make_sheet(double width, double depth, int target_vertices, unsigned seed) {
    check_arguments(width, depth, target_vertices);
    const double h = edge_length(width, depth, target_vertices);
    Random uniform(seed);
    PointSet set = scatter(width, depth, target_vertices, uniform);
    TriMesh sheet{lift(set.points, width, depth), triangulate(set.points)};
    for (int round = 0; round < kMaxRounds && smallest_angle(sheet) < kGoodSheetAngle; ++round) {
        if (round % kShakeEvery == kShakeEvery - 1) shake(set, sheet, h, uniform);
        smooth(set, sheet.faces);
        sheet = {lift(set.points, width, depth), triangulate(set.points)};
    }
    const double excess = static_cast<double>(sheet.vertices.rows()) / target_vertices - 1.0;
    if (smallest_angle(sheet) < 20.0 || std::abs(excess) > 0.03)
        throw ArgumentError("make_sheet: target_vertices",
                            std::to_string(target_vertices) + " vertices are too few for the shape",
                            "ask for more vertices");
    return sheet;
}

std::vector<int> sheet_corners(const TriMesh& sheet) {
    std::vector<int> corners;
    for (double z : {-1.0, 1.0})
        for (double x : {-1.0, 1.0}) {
            Eigen::Index corner = 0;
            (sheet.vertices * Vec3(x, 0.0, z)).maxCoeff(&corner);
            corners.push_back(static_cast<int>(corner));
        }
    return corners;
}

std::vector<int> sheet_side(const TriMesh& sheet, SheetSide side) {
    const bool across = side == SheetSide::left || side == SheetSide::right;
    const bool low = side == SheetSide::left || side == SheetSide::back;
    const VectorX coordinate = sheet.vertices.col(across ? 0 : 2);
    const double level = low ? coordinate.minCoeff() : coordinate.maxCoeff();
    const double tolerance = 1e-9 * (coordinate.maxCoeff() - coordinate.minCoeff());
    std::vector<int> vertices;
    for (Eigen::Index i = 0; i < coordinate.size(); ++i)
        if (std::abs(coordinate[i] - level) <= tolerance) vertices.push_back(static_cast<int>(i));
    const int along = across ? 2 : 0;
    std::sort(vertices.begin(), vertices.end(),
              [&](int a, int b) { return sheet.vertices(a, along) < sheet.vertices(b, along); });
    return vertices;
}

}  // namespace cloth
