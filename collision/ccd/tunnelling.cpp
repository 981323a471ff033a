#include "collision/ccd/tunnelling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "collision/ccd/fcl_sweep.h"
#include "collision/ccd/primitive_sweep.h"
#include "collision/geometry/gather_in_order.h"
#include "collision/proximity/obstacle_trees.h"
#include "collision/response/neighbour_pull.h"
#include "collision/response/resolve.h"
#include "data/core/triangle.h"

namespace cloth {
namespace {

constexpr double shallow = 5e-3;  // m: what starts or ends less deep is near where it went in
constexpr double least_thickness = 5e-3;  // m: thinner solids are not reported
// Way in each coordinate that a point makes at least, relative to what it goes through.
constexpr float least_motion = static_cast<float>(0.577 * least_thickness);
constexpr int points_per_part = 256;  // that a thread takes at once
constexpr int push_iterations = 3;    // of push_out_rows
constexpr ObstacleTreesSettings own_trees{0.5, 64};

using Corners = std::array<Vec3, 3>;

Corners corners_of(const Points& x, const Faces& faces, int face) {
    return {x.row(faces(face, 0)), x.row(faces(face, 1)), x.row(faces(face, 2))};
}

/// A place on an obstacle's surface, as it is at t + dt.
struct Place {
    bool known = false;
    double time = 0.0;  ///< when it was crossed, 0 to 1
    int face = -1;
    Vec3 barycentric = Vec3::Zero();  ///< in that face
    Vec3 point = Vec3::Zero(), normal = Vec3::Zero();
};

/// @param place  in the frame of a primitive
CarriedPoint carried_point(const Obstacle& obstacle, const Place& place) {
    if (obstacle.shape != ObstacleShape::mesh)
        return {-1,
                place.point,
                obstacle.pose0 * place.point,
                obstacle.pose1 * place.point,
                obstacle.pose0.linear() * place.normal,
                obstacle.pose1.linear() * place.normal};
    const Corners start = corners_of(obstacle.x0, *obstacle.faces, place.face);
    Vec3 point = Vec3::Zero(), normal = place.normal;
    for (int k = 0; k < 3; ++k) point += place.barycentric[k] * start[static_cast<size_t>(k)];
    Vec3 at_start;
    if (triangle_normal(start[0], start[1], start[2], at_start)) normal = at_start;
    return {place.face, place.barycentric, point, place.point, normal, place.normal};
}

/// Where a point that moves from p0 to p1 crosses a face, and whether to the outside.
bool cross_face(const Vec3& p0, const Vec3& p1, const Corners& start, const Corners& end, int face,
                Place& place, bool& outwards) {
    double time = 0.0;
    Vec3 normal;
    if (!first_touch(p0, p1, start, end, time) || !triangle_normal(end[0], end[1], end[2], normal))
        return false;
    Corners at;
    for (size_t k = 0; k < 3; ++k) at[k] = (1.0 - time) * start[k] + time * end[k];
    const Vec3 weight =
        closest_on_triangle((1.0 - time) * p0 + time * p1, at[0], at[1], at[2]).barycentric;
    Vec3 point = Vec3::Zero(), motion = p1 - p0;
    for (int k = 0; k < 3; ++k) {
        const auto corner = static_cast<size_t>(k);
        point += weight[k] * end[corner];
        motion -= weight[k] * (end[corner] - start[corner]);
    }
    outwards = (at[1] - at[0]).cross(at[2] - at[0]).dot(motion) > 0.0;
    place = {true, time, face, weight, point, normal};
    return true;
}

/// Of a mesh, of each face; null: it has none.
const std::vector<std::uint8_t>* usable_limbs(const Obstacle& mesh) {
    return !mesh.is_whole && has_limbs(mesh) ? mesh.limbs.get() : nullptr;
}

/// None where there are none, and for a place that is not on a face.
std::optional<int> limb_of(const std::vector<std::uint8_t>* limbs, int face) {
    if (face < 0 || !limbs) return std::nullopt;
    return (*limbs)[static_cast<size_t>(face)];
}

/// Equal times, as at a shared edge, go to the lowest face.
bool is_before(const Place& a, const Place& b) {
    return a.time < b.time || (a.time == b.time && a.face < b.face);
}

}  // namespace

/// A point's first way into an obstacle and its last way out of it.
struct TunnellingDetector::Crossing {
    int point = -1;
    Place in, out;
};

TunnellingDetector::TunnellingDetector(const Garment& garment, std::shared_ptr<ObstacleTrees> trees)
    : m_samples(garment),
      m_pinned(garment.is_pinned()),
      m_owns_trees(!trees),
      m_trees(trees ? std::move(trees) : std::make_shared<ObstacleTrees>(own_trees)),
      m_proximity({}, m_trees) {
    for (int i = 0; i < garment.vertex_count(); ++i)
        if (!m_pinned[static_cast<size_t>(i)]) m_vertices.push_back(i);
    m_proximity.query(garment.rest().vertices, Boundary(),
                      m_contacts);  // gives the rows their size
}

TunnellingDetector::~TunnellingDetector() = default;

std::optional<double> TunnellingDetector::thinnest() const {
    std::map<std::pair<int, std::optional<int>>, double> solids;
    for (const Tunnelling& solid : m_found) {
        double& thickness = solids[{solid.obstacle, solid.limb}];
        thickness = std::max(thickness, solid.thickness);
    }
    std::optional<double> thinnest;
    for (const auto& [solid, thickness] : solids)
        thinnest = std::min(thickness, thinnest.value_or(thickness));
    return thinnest;
}

/// Where a point that moves from p0 to p1 crosses the faces of a mesh.
TunnellingDetector::Crossing TunnellingDetector::cross(const Obstacle& mesh, const MotionTree& tree,
                                                       const Vec3& p0, const Vec3& p1,
                                                       LimbSet ignored, std::vector<int>& stack) {
    Crossing crossing;
    const MotionTree::Box box = tree.box_of(p0, p1 - p0);
    tree.for_each_met(box, least_motion, stack, [&](int face) {
        if (ignored != 0 && ((ignored >> (*mesh.limbs)[static_cast<size_t>(face)]) & 1u) != 0)
            return;
        Place place;
        bool outwards = false;
        if (!cross_face(p0, p1, corners_of(mesh.x0, *mesh.faces, face),
                        corners_of(mesh.x1, *mesh.faces, face), face, place, outwards))
            return;
        Place& kept = outwards ? crossing.out : crossing.in;
        if (!kept.known || is_before(place, kept) != outwards) kept = place;
    });
    // A way out before the way in is that of a point which started inside, and ended there.
    if (crossing.in.known && crossing.out.known && is_before(crossing.out, crossing.in))
        crossing.out = {};
    return crossing;
}

/// Ways in of points that start inside (end: start), or ways out of those that end inside, where
/// they are nearest to the surface.
void TunnellingDetector::complete(const Boundary& boundary, int obstacle, const Points& x,
                                  StepEnd end) {
    const bool start = end == StepEnd::start;
    m_rows.clear();
    for (const Crossing& crossing : m_crossings)
        if (!(start ? crossing.in : crossing.out).known) m_rows.push_back(crossing.point);
    if (m_rows.empty()) return;
    m_proximity.query_rows(x, m_rows, boundary, m_contacts, end);
    for (Crossing& crossing : m_crossings) {
        Place& place = start ? crossing.in : crossing.out;
        if (place.known) continue;
        const int i = crossing.point;
        const bool deep = m_contacts.obstacle[static_cast<size_t>(i)] != obstacle ||
                          m_contacts.distance[i] < -shallow;
        if (!deep)
            place = {true,
                     start ? 0.0 : 1.0,
                     m_contacts.face[static_cast<size_t>(i)],
                     m_contacts.barycentric.row(i),
                     m_contacts.point1.row(i),
                     m_contacts.normal1.row(i)};
        else if (!start)  // it is in there: as if through
            place = {true, 1.0, -1, Vec3::Zero(), x.row(i), -crossing.in.normal};
    }
}

void TunnellingDetector::report(const Crossing& crossing, const Boundary& boundary, int obstacle,
                                const std::vector<std::uint8_t>* limbs) {
    const Place& in = crossing.in;
    const Place& out = crossing.out;
    if (!in.known || !out.known || !(in.normal.dot(out.normal) < 0.0)) return;
    const std::optional<int> limb = limb_of(limbs, in.face), out_limb = limb_of(limbs, out.face);
    if (out_limb && limb != out_limb) return;
    const double thickness = (in.point - out.point).norm();
    if (thickness >= least_thickness)
        m_found.push_back({crossing.point, obstacle, limb, thickness,
                           carried_point(boundary.obstacles[static_cast<size_t>(obstacle)], in)});
}

void TunnellingDetector::find_in_mesh(const Boundary& boundary, int obstacle, const Points& x0,
                                      const Points& x1, const std::vector<int>& vertices,
                                      int threads) {
    const Obstacle& mesh = boundary.obstacles[static_cast<size_t>(obstacle)];
    const std::shared_ptr<const MotionTree> tree =
        (boundary.trees ? *boundary.trees : *m_trees).motion(mesh);
    if (!tree) return;
    const int count = static_cast<int>(vertices.size());
    const std::vector<std::uint8_t>* limbs = usable_limbs(mesh);
    const auto find_part = [&](int part, std::vector<Crossing>& out) {
        std::vector<int> stack;
        const int end = std::min(count, (part + 1) * points_per_part);
        for (int k = part * points_per_part; k < end; ++k) {
            const int i = vertices[static_cast<size_t>(k)];
            if ((ignored_limbs(boundary, i) & mesh.solid) != 0) continue;
            const LimbSet ignored = limbs ? ignored_limbs(boundary, i) : 0;
            Crossing crossing = cross(mesh, *tree, x0.row(i), x1.row(i), ignored, stack);
            if (!crossing.in.known && !crossing.out.known) continue;
            crossing.point = i;
            out.push_back(crossing);
        }
    };
    gather_in_order((count + points_per_part - 1) / points_per_part, threads, m_parts, m_crossings,
                    find_part);
    complete(boundary, obstacle, x0, StepEnd::start);
    complete(boundary, obstacle, x1, StepEnd::end);
    for (const Crossing& crossing : m_crossings) report(crossing, boundary, obstacle, limbs);
}

std::optional<CarriedPoint> TunnellingDetector::way_in(const Boundary& boundary,
                                                       const SurfaceSamples& samples, int sample,
                                                       const Points& x0) const {
    const auto row = static_cast<size_t>(sample);
    const Obstacle& mesh =
        boundary.obstacles[static_cast<size_t>(samples.contacts().obstacle[row])];
    if (mesh.shape != ObstacleShape::mesh) return std::nullopt;
    const std::shared_ptr<const MotionTree> tree =
        (boundary.trees ? *boundary.trees : *m_trees).motion(mesh);
    if (!tree) return std::nullopt;
    const std::vector<std::uint8_t>* limbs = usable_limbs(mesh);
    std::vector<int> stack;
    const Crossing crossing =
        cross(mesh, *tree, samples.corners(sample).position(x0), samples.position(sample),
              limbs ? samples.ignored(sample) : 0, stack);
    const Place& in = crossing.in;
    if (!in.known || limb_of(limbs, in.face) != limb_of(limbs, samples.contacts().face[row]))
        return std::nullopt;
    return carried_point(mesh, in);
}

void TunnellingDetector::add_samples(const Boundary& boundary, const Points& x0, const Points& x1,
                                     double depth) {
    m_proximity.query(x1, boundary, m_contacts, StepEnd::end);
    m_samples.find_deep(m_proximity, boundary, x1, m_contacts, depth, nullptr);
    for (const int sample : m_samples.deep()) {
        const std::optional<CarriedPoint> in = way_in(boundary, m_samples, sample, x0);
        if (!in) continue;
        const int obstacle = m_samples.contacts().obstacle[static_cast<size_t>(sample)];
        const Obstacle& mesh = boundary.obstacles[static_cast<size_t>(obstacle)];
        const double thickness = (in->point1 - m_samples.position(sample)).norm();
        m_found.push_back({static_cast<int>(x1.rows()) + sample, obstacle,
                           limb_of(usable_limbs(mesh), in->face),
                           std::max(thickness, least_thickness), *in});
    }
}

void TunnellingDetector::place_samples(const Points& x0, const Points& x1) {
    m_samples0.resize(m_samples.count(), 3);
    m_samples1.resize(m_samples.count(), 3);
    for (int sample = 0; sample < m_samples.count(); ++sample) {
        const SurfaceSamples::Corners corners = m_samples.corners(sample);
        m_samples0.row(sample) = corners.position(x0);
        m_samples1.row(sample) = corners.position(x1);
    }
    m_longest_way = std::sqrt((x1 - x0).rowwise().squaredNorm().maxCoeff());
}

void TunnellingDetector::find_in_primitive(const Boundary& boundary, int obstacle, const Points& x0,
                                           const Points& x1, const std::vector<int>& vertices) {
    const Obstacle& shape = boundary.obstacles[static_cast<size_t>(obstacle)];
    if (!is_usable_primitive(shape)) return;
    const Pose to_local0 = shape.pose0.inverse(), to_local1 = shape.pose1.inverse();
    const Vec3 centre = shape.pose0.translation();
    const double far = unreachable_distance(shape, m_longest_way), squared_far = far * far;
    const auto follow = [&](int point, const Vec3& from, const Vec3& to) {
        if ((from - centre).squaredNorm() > squared_far) return;
        const Vec3 p0 = to_local0 * from, p1 = to_local1 * to;
        const PrimitivePath path = follow_path(shape, p0, p1);
        if (!path.meets || path.in.distance < -shallow) return;
        const auto place = [](const PrimitiveHit& hit) {
            return Place{true, 0.0, -1, Vec3::Zero(), hit.point, hit.normal};
        };
        Crossing crossing{point, place(path.in), place(path.out)};
        if (path.out.distance < -shallow)
            crossing.out = {true, 1.0, -1, Vec3::Zero(), p1, -path.in.normal};
        report(crossing, boundary, obstacle, nullptr);
    };
    const int count = static_cast<int>(x0.rows());
    for (const int i : vertices)
        if ((ignored_limbs(boundary, i) & shape.solid) == 0) follow(i, x0.row(i), x1.row(i));
    for (int sample = 0; sample < m_samples.count(); ++sample) {
        if (!m_samples.is_movable(sample)) continue;
        LimbSet ignored = 0;
        if (shape.solid != 0)
            for (const int vertex : m_samples.corners(sample).vertex)
                ignored |= ignored_limbs(boundary, vertex);
        if ((ignored & shape.solid) == 0)
            follow(count + sample, m_samples0.row(sample), m_samples1.row(sample));
    }
}

/// Moves the vertices of a sample until it is so far outside of where it went in.
void TunnellingDetector::lift_corners(const Tunnelling& through, double clearance,
                                      Points& x) const {
    const CarriedPoint& in = through.in;
    const SurfaceSamples::Corners corners =
        m_samples.corners(through.point - static_cast<int>(x.rows()));
    const double depth = clearance + in.normal1.dot(in.point1 - corners.position(x));
    if (!(depth > 0.0)) return;
    for (int k = 0; k < corners.count(); ++k) {
        const int vertex = corners.vertex[static_cast<size_t>(k)];
        if (!m_pinned[static_cast<size_t>(vertex)]) x.row(vertex) += depth * in.normal1.transpose();
    }
}

void TunnellingDetector::hold_where_they_went_in(SurfaceContacts& contacts, Points& x) const {
    const int count = static_cast<int>(x.rows());
    for (const Tunnelling& through : m_found) {
        const CarriedPoint& in = through.in;
        const double height = in.normal1.dot(in.point1);
        if (through.point < count) {
            const int i = through.point;
            contacts.obstacle[static_cast<size_t>(i)] = through.obstacle;
            contacts.face[static_cast<size_t>(i)] = in.face;
            contacts.barycentric.row(i) = in.barycentric;
            contacts.point0.row(i) = in.point0;
            contacts.point1.row(i) = in.point1;
            contacts.normal0.row(i) = in.normal0;
            contacts.normal1.row(i) = in.normal1;
            contacts.distance[i] = 0.0;
            const double depth = height - x.row(i).dot(in.normal1);
            if (depth > 0.0) x.row(i) += depth * in.normal1.transpose();
            continue;
        }
        const SurfaceSamples::OnFace on = m_samples.on_face(through.point - count);
        contacts.ridges.push_back(
            {on.face, on.weight, in.normal1, height, in.normal0, in.point0, in.point1});
        lift_corners(through, 0.0, x);
    }
}

/// Vertices, also those of samples, that take_back() moves; ascending.
std::vector<int> TunnellingDetector::vertices_of_found() const {
    const int count = static_cast<int>(m_pinned.size());
    std::vector<int> vertices;
    const auto add = [&](int vertex) {
        if (!m_pinned[static_cast<size_t>(vertex)]) vertices.push_back(vertex);
    };
    for (const Tunnelling& through : m_found) {
        if (through.point < count) {
            add(through.point);
            continue;
        }
        const SurfaceSamples::Corners corners = m_samples.corners(through.point - count);
        for (int k = 0; k < corners.count(); ++k) add(corners.vertex[static_cast<size_t>(k)]);
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

std::vector<int> TunnellingDetector::inside(const Boundary& boundary,
                                            const std::vector<int>& vertices, const Points& x) {
    m_proximity.query_rows(x, vertices, boundary, m_contacts, StepEnd::end);
    std::vector<int> inside;
    for (const int i : vertices)
        if (m_contacts.has(i) && m_contacts.distance[i] < 0.0) inside.push_back(i);
    return inside;
}

double TunnellingDetector::take_back(const Boundary& boundary, const Points& x0, double clearance,
                                     int threads, Points& x, NeighbourPull* pull) {
    if (m_found.empty()) return 0.0;
    const Points before = x;
    std::vector<int> vertices = vertices_of_found();
    const auto put_back = [&](const std::vector<int>& rows) {
        for (const int row : rows) x.row(row) = before.row(row);
    };
    for (const Tunnelling& through : m_found) {
        const CarriedPoint& in = through.in;
        if (through.point < x.rows())
            x.row(through.point) = (in.point1 + clearance * in.normal1).transpose();
        else
            lift_corners(through, clearance, x);
    }
    if (pull) {
        std::vector<int> followers = pull->follow(vertices, before, x);
        vertices.insert(vertices.end(), followers.begin(), followers.end());
        std::sort(vertices.begin(), vertices.end());
        m_proximity.query_rows(x, followers, boundary, m_contacts, StepEnd::end);
        push_out_rows(m_proximity, boundary, clearance, push_iterations, followers, x, m_contacts);
    }
    put_back(inside(boundary, vertices, x));
    search(boundary, x0, x, vertices, threads);
    if (!m_found.empty()) {
        put_back(vertices_of_found());
        search(boundary, x0, x, m_vertices, threads);
    }
    m_moved.assign(m_pinned.size(), 0);
    for (const int vertex : vertices)
        m_moved[static_cast<size_t>(vertex)] = x.row(vertex) != before.row(vertex);
    return m_samples.depth_beside(m_proximity, boundary, x, m_moved);
}

const std::vector<Tunnelling>& TunnellingDetector::find(const Boundary& boundary, const Points& x0,
                                                        const Points& x1, int threads) {
    if (m_owns_trees) m_trees->begin_step();
    search(boundary, x0, x1, m_vertices, threads);
    return m_found;
}

/// Of these vertices, and of all samples.
void TunnellingDetector::search(const Boundary& boundary, const Points& x0, const Points& x1,
                                const std::vector<int>& vertices, int threads) {
    m_found.clear();
    const auto is_mesh = [](const Obstacle& obstacle) {
        return obstacle.shape == ObstacleShape::mesh;
    };
    if (!std::all_of(boundary.obstacles.begin(), boundary.obstacles.end(), is_mesh))
        place_samples(x0, x1);
    for (int k = 0; k < static_cast<int>(boundary.obstacles.size()); ++k) {
        if (is_mesh(boundary.obstacles[static_cast<size_t>(k)]))
            find_in_mesh(boundary, k, x0, x1, vertices, threads);
        else
            find_in_primitive(boundary, k, x0, x1, vertices);
    }
}

}  // namespace cloth
