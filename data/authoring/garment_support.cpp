#include "data/authoring/garment_support.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "data/authoring/mesh_quality.h"

namespace cloth {

namespace {

constexpr double looks_up = 0.7;         // y of the way out of the skin
constexpr double lies_within = 0.03;     // of the skin (m)
constexpr double least_lying = 0.004;    // of the area: straps are narrow
constexpr double pin_band = 0.03;        // height of the pins below the upper edge (m)
constexpr double falls_by = 0.25;        // to the shoulders, at most (m)
constexpr double least_landing = 1e-3;   // of the square of the height
constexpr double shoulder_height = 0.7;  // of the body's: what lies on hips or feet is not held
constexpr double neck_height = 0.8;      // of the body's: no waistband is there
constexpr double farthest_band = 2.0;    // of the waist's girth: what is longer is not near it

/// Heights of the skin, as parts of the body's.
struct Heights {
    double low = 0.0, size = 1.0;
    explicit Heights(const Points& skin)
        : low(skin.col(1).minCoeff()), size(skin.col(1).maxCoeff() - skin.col(1).minCoeff()) {}
    double operator()(double y) const { return (y - low) / size; }
};

/// The part of the upper half's faces that lies on skin which looks upwards, by area.
double lying_share(const TriMesh& worn, const SurfaceDistance& skin) {
    const VectorX area = face_area_vectors(worn.vertices, worn.faces).rowwise().norm();
    const double middle = 0.5 * (worn.vertices.col(1).minCoeff() + worn.vertices.col(1).maxCoeff());
    double lying = 0.0;
    for (Eigen::Index f = 0; f < worn.faces.rows(); ++f) {
        const Vec3 at = (worn.vertices.row(worn.faces(f, 0)) + worn.vertices.row(worn.faces(f, 1)) +
                         worn.vertices.row(worn.faces(f, 2))) /
                        3.0;
        if (at.y() < middle) continue;
        const auto near = skin.nearest_within(lies_within, at);
        if (near && near->normal.y() > looks_up) lying += area[f];
    }
    return lying / area.sum();
}

using Point2 = Eigen::Vector2d;

/// The skin that a point would fall on, straight down.
class SkinBelow {
 public:
    explicit SkinBelow(const TriMesh& skin)
        : m_skin(skin), m_normals(face_normals(skin.vertices, skin.faces)) {
        m_low = skin.vertices.colwise().minCoeff();
        for (int f = 0; f < skin.faces.rows(); ++f) {
            if (m_normals(f, 1) <= 0.0) continue;
            const Points corners = skin.vertices(skin.faces.row(f), Eigen::all);
            const Eigen::RowVector3d low = corners.colwise().minCoeff(),
                                     high = corners.colwise().maxCoeff();
            for (int i = cell_of(low.x(), 0); i <= cell_of(high.x(), 0); ++i)
                for (int k = cell_of(low.z(), 2); k <= cell_of(high.z(), 2); ++k)
                    m_faces[{i, k}].push_back(f);
        }
    }

    /// What it meets first: its height, and how far it looks upwards. Nothing: the ground.
    std::optional<std::pair<double, double>> first(const Vec3& from) const {
        const auto cell = m_faces.find({cell_of(from.x(), 0), cell_of(from.z(), 2)});
        std::optional<std::pair<double, double>> best;
        if (cell == m_faces.end()) return best;
        for (const int f : cell->second) {
            const auto y = height_of(f, from);
            if (y && *y <= from.y() && (!best || *y > best->first)) best = {*y, m_normals(f, 1)};
        }
        return best;
    }

 private:
    static constexpr double kCell = 0.02;  // (m)

    int cell_of(double at, int axis) const {
        return static_cast<int>(std::floor((at - m_low[axis]) / kCell));
    }

    /// Where the vertical line through a point meets a face.
    std::optional<double> height_of(int f, const Vec3& at) const {
        const Vec3 a = m_skin.vertices.row(m_skin.faces(f, 0));
        const Vec3 n = m_normals.row(f);
        for (int c = 0; c < 3; ++c) {
            const Vec3 p = m_skin.vertices.row(m_skin.faces(f, c));
            const Vec3 q = m_skin.vertices.row(m_skin.faces(f, (c + 1) % 3));
            // Seen from above, faces that look upwards go around clockwise in x and z.
            if ((q.x() - p.x()) * (at.z() - p.z()) - (q.z() - p.z()) * (at.x() - p.x()) > 0.0)
                return std::nullopt;
        }
        return a.y() - (n.x() * (at.x() - a.x()) + n.z() * (at.z() - a.z())) / n.y();
    }

    const TriMesh& m_skin;
    Points m_normals;
    Eigen::RowVector3d m_low;
    std::map<std::pair<int, int>, std::vector<int>> m_faces;
};

/// The area that would fall on shoulders, arms or head (m^2): a poncho is modelled flat, and a
/// scarf loose.
double landing_area(const TriMesh& worn, const TriMesh& skin) {
    const Heights part(skin.vertices);
    const SkinBelow below(skin);
    const VectorX area = face_area_vectors(worn.vertices, worn.faces).rowwise().norm();
    double landing = 0.0;
    for (Eigen::Index f = 0; f < worn.faces.rows(); ++f) {
        const Vec3 at = worn.vertices(worn.faces.row(f), Eigen::all).colwise().mean();
        if (part(at.y()) < shoulder_height) continue;
        const auto met = below.first(at);
        if (met && part(met->first) > shoulder_height && met->second > looks_up &&
            at.y() - met->first < falls_by)
            landing += area[f];
    }
    return landing;
}

/// How often a closed polygon goes around a point.
int winding(const std::vector<Point2>& polygon, const Point2& centre) {
    double angle = 0.0;
    for (size_t i = 0; i < polygon.size(); ++i) {
        const Point2 a = polygon[i] - centre, b = polygon[(i + 1) % polygon.size()] - centre;
        angle += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    }
    return static_cast<int>(std::lround(angle / (2.0 * M_PI)));
}

/// Length of the convex hull's outline (Andrew's monotone chain).
double hull_length(std::vector<Point2> points) {
    std::sort(points.begin(), points.end(), [](const Point2& a, const Point2& b) {
        return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
    });
    double length = 0.0;
    for (int side = 0; side < 2; ++side) {
        std::vector<Point2> chain;
        for (const Point2& p : points) {
            while (chain.size() > 1) {
                const Point2 a = chain.back() - chain[chain.size() - 2], b = p - chain.back();
                if (a.x() * b.y() - a.y() * b.x() > 0.0) break;
                chain.pop_back();
            }
            chain.push_back(p);
        }
        for (size_t i = 1; i < chain.size(); ++i) length += (chain[i] - chain[i - 1]).norm();
        std::reverse(points.begin(), points.end());
    }
    return length;
}

struct Loop {
    std::vector<int> vertices;
    Vec3 centre = Vec3::Zero();
    bool around_body = false;
    bool level = false;  ///< it goes around what stands, not around an arm that is spread
};

/// The area vector of a closed polygon that need not be flat (m^2).
Vec3 polygon_area(const Points& x) {
    const Vec3 centre = x.colwise().mean();
    Vec3 area = Vec3::Zero();
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const Vec3 a = x.row(i).transpose() - centre;
        area += 0.5 * a.cross(x.row((i + 1) % x.rows()).transpose() - centre);
    }
    return area;
}

/// A border may pass by the body on both sides without going around it, as that of a scarf does.
Loop loop_of(const TriMesh& worn, std::vector<int> vertices, const SurfaceDistance& skin) {
    Loop loop;
    const Points x = worn.vertices(vertices, Eigen::all);
    loop.centre = x.colwise().mean().transpose();
    const Vec3 axis = polygon_area(x).normalized();
    const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
    std::vector<Point2> flat;
    for (const auto& p : x.rowwise()) flat.emplace_back(p.dot(u), p.dot(v));
    loop.vertices = std::move(vertices);
    loop.level = std::abs(axis.y()) > 0.5;
    loop.around_body = skin.nearest(loop.centre).distance < 0.0 &&
                       winding(flat, {loop.centre.dot(u), loop.centre.dot(v)}) != 0;
    return loop;
}

/// Highest first.
std::vector<Loop> loops_of(const TriMesh& worn, const SurfaceDistance& skin) {
    std::vector<Loop> loops;
    for (std::vector<int>& loop : boundary_loops(worn.faces))
        loops.push_back(loop_of(worn, std::move(loop), skin));
    std::sort(loops.begin(), loops.end(),
              [](const Loop& a, const Loop& b) { return a.centre.y() > b.centre.y(); });
    return loops;
}

double length_of(const Points& x) {
    double length = 0.0;
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        length += (x.row((i + 1) % x.rows()) - x.row(i)).norm();
    return length;
}

/// Of the convex section of the body within a loop, at its height (m). Arms beside it do not count.
double girth_within(const Points& x, const TriMesh& skin) {
    constexpr double room = 1.1;  // a loop that is not level may cut the section
    const double height = x.col(1).mean();
    const Point2 centre(x.col(0).mean(), x.col(2).mean());
    std::vector<Point2> outline, section;
    for (const auto& p : x.rowwise())
        outline.push_back(centre + room * (Point2(p.x(), p.z()) - centre));
    for (const auto& [a, b] : undirected_edges(skin.faces)) {
        const Vec3 p = skin.vertices.row(a), q = skin.vertices.row(b);
        if ((p.y() < height) == (q.y() < height)) continue;
        const Vec3 at = p + (height - p.y()) / (q.y() - p.y()) * (q - p);
        if (winding(outline, {at.x(), at.z()}) != 0) section.emplace_back(at.x(), at.z());
    }
    return hull_length(std::move(section));
}

/// The upper edge may be a waistband if it goes around the trunk, and is not so far from it that
/// only hands could hold it.
bool can_be_waistband(const TriMesh& worn, const Loop& loop, const GarmentSupport& support,
                      const Heights& part) {
    const double middle = 0.5 * (worn.vertices.col(1).minCoeff() + worn.vertices.col(1).maxCoeff());
    return loop.around_body && loop.level && loop.centre.y() > middle &&
           part(loop.centre.y()) < neck_height &&
           support.edge_length < farthest_band * support.waist_girth;
}

/// @param bottom, top, width  as parts of the body's height
std::string sort_of(const GarmentSupport& support, const std::vector<Loop>& loops, double bottom,
                    double top, double width) {
    if (bottom > 0.85 && top > 0.93 && width < 0.4) return "hat";
    if (top < 0.2) return "shoes";
    const auto around = std::count_if(loops.begin(), loops.end(),
                                      [](const Loop& loop) { return loop.around_body; });
    if (support.kind == GarmentSupport::Kind::shoulders) {
        if (bottom > neck_height || around == 0) return "wrap";
        if (bottom > 0.4) return "top";
        return loops.size() >= 5 ? "suit" : "dress";
    }
    if (support.kind == GarmentSupport::Kind::pins) return "piece";
    if (around == 3) return "trousers";
    return top > 0.7 ? "dress" : "skirt";
}

}  // namespace

const char* name_of(GarmentSupport::Kind kind) {
    switch (kind) {
        case GarmentSupport::Kind::shoulders:
            return "shoulders";
        case GarmentSupport::Kind::waistband:
            return "waistband";
        case GarmentSupport::Kind::pins:
            break;
    }
    return "pins";
}

GarmentSupport find_support(const TriMesh& worn, const SurfaceDistance& skin) {
    GarmentSupport support;
    const Heights part(skin.surface().vertices);
    support.lying_share = lying_share(worn, skin);
    support.landing_area = landing_area(worn, skin.surface());
    const std::vector<Loop> loops = loops_of(worn, skin);
    const double top = worn.vertices.col(1).maxCoeff();
    support.pin_low = top - pin_band;
    support.pin_high = top;
    if (support.lying_share > least_lying ||
        support.landing_area > least_landing * part.size * part.size) {
        support.kind = GarmentSupport::Kind::shoulders;
    } else if (!loops.empty()) {
        const Points edge = worn.vertices(loops.front().vertices, Eigen::all);
        support.edge_length = length_of(edge);
        support.waist_girth = girth_within(edge, skin.surface());
        if (can_be_waistband(worn, loops.front(), support, part)) {
            support.kind = GarmentSupport::Kind::waistband;
            support.upper_edge = loops.front().vertices;
            support.pin_low = edge.col(1).minCoeff() - 1e-3;
        }
    }
    support.pinned_share = share_between(worn.vertices, support);
    const double width = worn.vertices.col(0).maxCoeff() - worn.vertices.col(0).minCoeff();
    support.sort = sort_of(support, loops, part(worn.vertices.col(1).minCoeff()), part(top),
                           width / part.size);
    return support;
}

GarmentSupport support_of_all(const std::vector<GarmentSupport>& pieces) {
    using Kind = GarmentSupport::Kind;
    const auto holds_less = [](const GarmentSupport& a, const GarmentSupport& b) {
        return a.kind < b.kind;
    };
    const auto has = [&](Kind kind) {
        return std::any_of(pieces.begin(), pieces.end(),
                           [kind](const GarmentSupport& piece) { return piece.kind == kind; });
    };
    GarmentSupport all = *std::max_element(pieces.begin(), pieces.end(), holds_less);
    if (has(Kind::shoulders) && has(Kind::waistband)) all.sort = "suit";
    all.upper_edge.clear();
    for (const GarmentSupport& piece : pieces)
        all.upper_edge.insert(all.upper_edge.end(), piece.upper_edge.begin(),
                              piece.upper_edge.end());
    return all;
}

bool lies_on_its_side(const TriMesh& mesh) {
    std::vector<Vec3> openings;
    for (const std::vector<int>& loop : boundary_loops(mesh.faces))
        openings.push_back(polygon_area(mesh.vertices(loop, Eigen::all)));
    if (openings.size() < 2) return false;
    std::sort(openings.begin(), openings.end(),
              [](const Vec3& a, const Vec3& b) { return a.norm() > b.norm(); });
    const Vec3 a = openings[0].normalized(), b = openings[1].normalized();
    return openings[1].norm() > 0.05 * openings[0].norm() && std::abs(a.dot(b)) > 0.9 &&
           std::abs(a.y()) < 0.3 && std::abs(b.y()) < 0.3;
}

double share_between(const Points& x, const GarmentSupport& support) {
    const auto y = x.col(1).array();
    return (y >= support.pin_low && y <= support.pin_high).cast<double>().mean();
}

}  // namespace cloth
