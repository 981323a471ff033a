#include "collision/proximity/proximity.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "collision/geometry/faces_in_range.h"
#include "collision/geometry/spatial_order.h"
#include "collision/proximity/mesh_surface.h"
#include "collision/proximity/obstacle_trees.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/primitives.h"
#include "data/core/triangle.h"

namespace cloth {

namespace {

constexpr double no_distance = std::numeric_limits<double>::infinity();
constexpr int forget_after = 64;       // queries
constexpr int reorder_after = 32;      // queries
constexpr size_t few_rows = 16;        // one row of so many is not worth bringing into order
constexpr size_t max_answer_sets = 4;  // sets of query points of different size
// Work that is worth waking threads for, which are late where other programs keep the cores busy.
// One: a point against a primitive, about 20 ns.
constexpr double min_parallel = 4096;
constexpr double mesh_work = 32;

/// What a query point was told last.
struct Answer {
    SurfaceHit hit;
    int hint = -1;          ///< the face that was nearest when there was one
    Vec3 x = Vec3::Zero();  ///< the point (m)
    double radius = -1.0;   ///< of the search (m)
    LimbSet ignored = 0;
    unsigned pose = 0;  ///< see Answers

    /// Whether a search would find the same to the bit, as long as the surface has not moved. It
    /// would, too, if it passed over more limbs than the answered one did, or looked less far (see
    /// find_nearest), as long as no face at what was found is of such a limb.
    bool is_to(const Vec3& point, double within, LimbSet passed_over) const {
        return within <= radius && x == point && (ignored & ~passed_over) == 0 &&
               (hit.limbs & passed_over & ~ignored) == 0;
    }
};

/// The answers to the points of the last query of as many points. A step begins with the points
/// and the surface that the last one ended with: it need not search again.
struct Answers {
    std::shared_ptr<const MeshSurface> surface;  ///< held, so that it stays as it is
    std::vector<Answer> of;
    unsigned pose = 0;  ///< counts the surfaces; older answers are of no use

    void begin_query(const std::shared_ptr<const MeshSurface>& asked) {
        if (asked == surface) return;
        surface = asked;
        if (++pose != 0) return;
        for (Answer& answer : of) answer.radius = -1.0;  // the numbers start again
    }
};

/// The order in which as many points are searched for.
struct SearchOrder {
    std::vector<int> rows;
    int queries = 0;
};

/// What is remembered of a mesh between queries.
struct SearchedMesh {
    std::shared_ptr<const Faces> faces;  // held, so that the pointer stays a key
    std::shared_ptr<const std::vector<std::uint8_t>> limbs;
    int occurrence;  // the same faces may stand in one boundary several times
    long last_seen;
    std::vector<Answers> answer_sets;  // the latest first
};

/// One usable obstacle of the boundary, ready for queries.
struct Target {
    int index;
    const Obstacle* obstacle;
    std::shared_ptr<const MeshSurface> surface;  // null: a primitive
    Answers* answers;                            // of a mesh
    // Of a primitive:
    Pose to_local = Pose::Identity();  // from the world to its frame
    Vec3 centre = Vec3::Zero();        // of that frame (m)
    double reach = 0.0;                // see reach_of_primitive()

    /// Of the limbs that a row ignores, those that it ignores here.
    LimbSet ignored_here(LimbSet ignored) const { return obstacle->is_whole ? 0 : ignored; }

    /// Whether it is surely farther from x than `distance` (m).
    bool is_beyond(const Vec3& x, double distance) const {
        constexpr double rounding = 1.0 + 1e-5;  // frames are turned as exactly as floats are
        const double away = reach + distance;
        return (x - centre).squaredNorm() > rounding * away * away;
    }
};

/// The nearest surface point found so far for one query point.
struct Nearest {
    const Target* target = nullptr;
    double distance = no_distance;
    double clearance = no_distance;  // no surface is nearer
    SurfaceHit on_mesh;
    Vec3 x = Vec3::Zero();  // where a primitive is the nearest: the point in its frame (m)
};

Answers& answers_for(SearchedMesh& mesh, size_t count) {
    auto& sets = mesh.answer_sets;
    auto found = std::find_if(sets.begin(), sets.end(),
                              [&](const Answers& set) { return set.of.size() == count; });
    if (found == sets.end()) {
        if (sets.size() == max_answer_sets) sets.pop_back();
        sets.emplace_back().of.resize(count);
        found = std::prev(sets.end());
    }
    std::rotate(sets.begin(), found, found + 1);
    return sets.front();
}

/// Searches for points, several in one pass, where they have not been answered yet; the faces that
/// were nearest last are where the search begins. find_nearest() then reads the answers.
class SearchTogether {
 public:
    SearchTogether(const Target& target, ClosestFaceTree::Stack& stack)
        : m_target(target), m_stack(stack) {}

    void add(const Vec3& x, size_t point, double radius, LimbSet limbs) {
        const Answer& answer = m_target.answers->of[point];
        const LimbSet ignored = m_target.ignored_here(limbs);
        if (!x.allFinite() || (m_target.obstacle->solid & limbs) != 0 ||
            (answer.pose == m_target.answers->pose && answer.is_to(x, radius, ignored)))
            return;
        m_points[m_count] = point;
        m_queries[m_count++] = {x, radius, answer.hint, ignored};
        if (m_count == ClosestFaceTree::packet) search();
    }

    void search() {
        if (m_count == 0) return;
        SurfaceHit hits[ClosestFaceTree::packet];
        m_target.surface->closest(m_queries, m_count, m_stack, hits);
        for (int k = 0; k < m_count; ++k) {
            const ClosestFaceTree::Query& query = m_queries[k];
            const int hint = hits[k].face >= 0 ? hits[k].face : query.hint;
            m_target.answers->of[m_points[k]] = {
                hits[k], hint, query.x, query.radius, query.ignored, m_target.answers->pose};
        }
        m_count = 0;
    }

 private:
    const Target& m_target;
    ClosestFaceTree::Stack& m_stack;
    int m_count = 0;
    size_t m_points[ClosestFaceTree::packet];
    ClosestFaceTree::Query m_queries[ClosestFaceTree::packet];
};

Nearest find_nearest(const std::vector<Target>& targets, const Vec3& x, size_t point, double radius,
                     LimbSet ignored) {
    Nearest nearest;
    if (!x.allFinite()) {
        nearest.clearance = radius;
        return nearest;
    }
    for (const Target& target : targets) {
        if ((target.obstacle->solid & ignored) != 0) continue;
        if (target.surface) {
            nearest.clearance = std::min(nearest.clearance, radius);
            const SurfaceHit& hit = target.answers->of[point].hit;
            if (hit.face < 0 || hit.distance >= nearest.distance) continue;
            if (std::abs(hit.distance) > radius) continue;
            nearest.on_mesh = hit;
            nearest.distance = hit.distance;
        } else {
            if (target.is_beyond(x, nearest.clearance)) continue;
            const Vec3 local = target.to_local * x;
            const double distance = distance_to_primitive(*target.obstacle, local);
            nearest.clearance = std::min(nearest.clearance, distance);
            if (distance > radius || distance >= nearest.distance) continue;
            nearest.x = local;
            nearest.distance = distance;
        }
        nearest.target = &target;
    }
    nearest.clearance = std::min(nearest.clearance, nearest.distance);
    return nearest;
}

/// A point of a face and the face's normal; without area there, the normal is left as it is.
void place_on_face(const Points& x, const Faces& faces, const SurfaceHit& hit, Vec3& point,
                   Vec3& normal) {
    const Vec3 a = x.row(faces(hit.face, 0)), b = x.row(faces(hit.face, 1));
    const Vec3 c = x.row(faces(hit.face, 2));
    const Vec3& w = hit.barycentric;
    point = w[0] * a + w[1] * b + w[2] * c;
    Vec3 fresh;
    if (triangle_normal(a, b, c, fresh)) normal = fresh;
}

/// The row has no contact; what its other columns hold means nothing.
void store_none(SurfaceContacts& contacts, Eigen::Index i) {
    contacts.obstacle[size_t(i)] = contacts.face[size_t(i)] = -1;
    contacts.distance[i] = no_distance;
}

void clear_row(SurfaceContacts& contacts, Eigen::Index i) {
    store_none(contacts, i);
    for (Points* rows : {&contacts.barycentric, &contacts.point0, &contacts.point1,
                         &contacts.normal0, &contacts.normal1})
        rows->row(i).setZero();
}

void store_row(const Nearest& nearest, StepEnd chosen_at, const QueryLimits& limits, Eigen::Index i,
               SurfaceContacts& contacts) {
    contacts.clearance[i] = nearest.clearance;
    if (nearest.distance > limits.store_within) return store_none(contacts, i);
    if (!nearest.target) return clear_row(contacts, i);
    const Obstacle& obstacle = *nearest.target->obstacle;
    Vec3 point[2], normal[2];
    if (nearest.target->surface) {
        const Points* ends[2] = {&obstacle.x0, &obstacle.x1};
        const int chosen = chosen_at == StepEnd::start ? 0 : 1, carried = 1 - chosen;
        ends[chosen] = &nearest.target->surface->vertices();  // the same, read by the search
        for (const int end : {chosen, carried}) {
            if (end == carried) normal[carried] = normal[chosen];
            place_on_face(*ends[end], *obstacle.faces, nearest.on_mesh, point[end], normal[end]);
        }
        if (!point[carried].allFinite()) return clear_row(contacts, i);
        contacts.barycentric.row(i) = nearest.on_mesh.barycentric;
    } else {
        const PrimitiveHit hit = closest_on_primitive(obstacle, nearest.x);
        const Pose* ends[2] = {&obstacle.pose0, &obstacle.pose1};
        for (const int end : {0, 1}) {
            point[end] = *ends[end] * hit.point;
            normal[end] = ends[end]->linear() * hit.normal;
        }
        contacts.barycentric.row(i) = hit.point;
    }
    contacts.obstacle[size_t(i)] = nearest.target->index;
    contacts.face[size_t(i)] = nearest.target->surface ? nearest.on_mesh.face : -1;
    contacts.point0.row(i) = point[0];
    contacts.point1.row(i) = point[1];
    contacts.normal0.row(i) = normal[0];
    contacts.normal1.row(i) = normal[1];
    contacts.distance[i] = nearest.distance;
}

void resize(SurfaceContacts& contacts, Eigen::Index count) {
    contacts.obstacle.resize(size_t(count));
    contacts.face.resize(size_t(count));
    for (Points* rows : {&contacts.barycentric, &contacts.point0, &contacts.point1,
                         &contacts.normal0, &contacts.normal1})
        rows->resize(count, 3);
    contacts.distance.resize(count);
    contacts.clearance.resize(count);
    contacts.ridges.clear();
}

}  // namespace

struct Proximity::Impl {
    ProximitySettings settings;
    std::shared_ptr<ObstacleTrees> given;  // or null
    ObstacleTrees own;
    long queries = 0;
    std::vector<SearchedMesh> meshes;
    std::vector<Target> targets;
    std::vector<ClosestFaceTree::Stack> stacks;  // one per thread
    std::vector<SearchOrder> orders;
    std::vector<int> ordered;    // rows
    std::vector<char> is_asked;  // |V|

    int thread_count() const {
        return settings.threads > 0 ? settings.threads : omp_get_max_threads();
    }

    Impl(const ProximitySettings& asked, std::shared_ptr<ObstacleTrees> trees)
        : settings(asked),
          given(std::move(trees)),
          own(ObstacleTreesSettings{asked.radius, forget_after}) {}

    ObstacleTrees& trees_for(const Boundary& boundary) {
        for (ObstacleTrees* trees : {boundary.trees.get(), given.get()})
            if (trees && trees->settings().radius >= settings.radius) return *trees;
        return own;
    }

    SearchedMesh& known(const Obstacle& obstacle) {
        int occurrence = 0;
        for (SearchedMesh& mesh : meshes) {
            if (mesh.faces != obstacle.faces || mesh.limbs != obstacle.limbs) continue;
            if (mesh.last_seen == queries) {
                ++occurrence;
                continue;
            }
            if (mesh.occurrence == occurrence) return mesh;
        }
        meshes.push_back({obstacle.faces, obstacle.limbs, occurrence, queries, {}});
        return meshes.back();
    }

    void add_target(int index, const Obstacle& obstacle, ObstacleTrees& trees, StepEnd end,
                    size_t count) {
        Target target{index, &obstacle, nullptr, nullptr};
        if (obstacle.shape != ObstacleShape::mesh) {
            if (!is_usable_primitive(obstacle)) return;
            const Pose& pose = end == StepEnd::start ? obstacle.pose0 : obstacle.pose1;
            target.to_local = pose.inverse();
            target.centre = pose.translation();
            target.reach = reach_of_primitive(obstacle);
        } else {
            target.surface = trees.surface(obstacle, end);
            if (!target.surface) return;
            SearchedMesh& mesh = known(obstacle);
            mesh.last_seen = queries;
            target.answers = &answers_for(mesh, count);
            target.answers->begin_query(target.surface);
        }
        targets.push_back(std::move(target));
    }

    void prepare(const Boundary& boundary, StepEnd end, size_t count) {
        ++queries;
        own.begin_step();
        targets.clear();
        for (size_t i = 0; i < boundary.obstacles.size(); ++i)
            add_target(static_cast<int>(i), boundary.obstacles[i], trees_for(boundary), end, count);
        meshes.erase(std::remove_if(meshes.begin(), meshes.end(),
                                    [&](const SearchedMesh& mesh) {
                                        return queries - mesh.last_seen > forget_after;
                                    }),
                     meshes.end());
        stacks.resize(std::max(stacks.size(), size_t(thread_count())));
    }

    int threads_for(int points) const {
        double work = 0.0;
        for (const Target& target : targets) work += points * (target.surface ? mesh_work : 1.0);
        return work < min_parallel ? 1 : thread_count();
    }

    /// Neighbours follow each other. Made anew now and then: points move slowly.
    const std::vector<int>& order_of(const Points& x) {
        const auto count = static_cast<size_t>(x.rows());
        auto order = std::find_if(orders.begin(), orders.end(), [&](const SearchOrder& known) {
            return known.rows.size() == count;
        });
        if (order == orders.end()) {
            if (orders.size() == max_answer_sets) orders.erase(orders.begin());
            orders.emplace_back();
            order = std::prev(orders.end());
        }
        if (order->rows.size() != count) {
            order->rows.resize(count);
            std::iota(order->rows.begin(), order->rows.end(), 0);
        }
        if (any_mesh() && order->queries++ % reorder_after == 0)
            order->rows = spatial_order(x, ClosestFaceTree::packet);
        return order->rows;
    }

    bool any_mesh() const {
        return std::any_of(targets.begin(), targets.end(),
                           [](const Target& target) { return target.surface != nullptr; });
    }

    /// The rows of x to search for, in an order that suits; null: all of them.
    const std::vector<int>& rows_in_order(const Points& x, const std::vector<int>* rows) {
        if (rows && (!any_mesh() || rows->size() * few_rows < size_t(x.rows()))) return *rows;
        if (!rows || rows->size() == size_t(x.rows())) return order_of(x);
        is_asked.assign(size_t(x.rows()), 0);
        for (const int i : *rows) is_asked[size_t(i)] = 1;
        ordered.clear();
        for (const int i : order_of(x))
            if (is_asked[size_t(i)]) ordered.push_back(i);
        return ordered;
    }

    std::optional<Cover> cover(const SurfaceContacts& contacts, Eigen::Index i, StepEnd chosen_at,
                               LimbSet ignored, ClosestFaceTree::Stack& stack) const {
        if (!contacts.has(i)) return std::nullopt;
        const Points& points = chosen_at == StepEnd::start ? contacts.point0 : contacts.point1;
        for (const Target& target : targets)
            if (target.index == contacts.obstacle[size_t(i)] && target.surface)
                return target.surface->cover(points.row(i), contacts.face[size_t(i)],
                                             Cover::farthest, stack, ignored);
        return std::nullopt;
    }

    /// Calls store(i, nearest) for the given rows of x; null: for all of them.
    /// @param limits  QueryLimits::ignored that has other rows than x is passed over
    template <class Store>
    void for_each_nearest(const Points& x, const std::vector<int>* rows, const Boundary& boundary,
                          const QueryLimits& limits, const Store& store) {
        const std::vector<LimbSet>& ignored =
            limits.ignored ? *limits.ignored : boundary.ignored_limbs;
        const double largest = std::min(limits.radius, settings.radius);
        const std::vector<int>& order = rows_in_order(x, rows);
        const int count = static_cast<int>(order.size());
        const int threads = threads_for(count);
        const auto passed_over = [&](int i) {
            return ignored.size() == size_t(x.rows()) ? ignored[size_t(i)] : 0;
        };
        const auto radius = [&](int i) {
            return limits.radii ? std::min((*limits.radii)[i], largest) : largest;
        };
        // Neighbours, which visit the same nodes; of those that are answered few may be left.
        constexpr int packet = ClosestFaceTree::packet;
        const int block = packet * std::clamp(count / (16 * packet), 1, 16);
#pragma omp parallel for num_threads(threads) schedule(dynamic, 1) if (threads > 1)
        for (int first = 0; first < count; first += block) {
            ClosestFaceTree::Stack& stack = stacks[size_t(omp_get_thread_num())];
            const int last = std::min(first + block, count);
            for (const Target& target : targets) {
                if (!target.surface) continue;
                SearchTogether together(target, stack);
                for (int at = first; at < last; ++at) {
                    const int i = order[size_t(at)];
                    together.add(x.row(i), size_t(i), radius(i), passed_over(i));
                }
                together.search();
            }
            for (int at = first; at < last; ++at) {
                const int i = order[size_t(at)];
                store(i, find_nearest(targets, x.row(i), size_t(i), radius(i), passed_over(i)));
            }
        }
    }
};

Proximity::Proximity(ProximitySettings settings, std::shared_ptr<ObstacleTrees> trees) {
    check_range("ProximitySettings.radius", settings.radius, 0.01, 2.0);
    check_range("ProximitySettings.threads", settings.threads, 0, 1024);
    m_impl = std::make_unique<Impl>(settings, std::move(trees));
}

Proximity::~Proximity() = default;
Proximity::Proximity(Proximity&&) noexcept = default;
Proximity& Proximity::operator=(Proximity&&) noexcept = default;

const ProximitySettings& Proximity::settings() const {
    return m_impl->settings;
}

int Proximity::cached_meshes() const {
    return static_cast<int>(m_impl->meshes.size());
}

void Proximity::query(const Points& x, const Boundary& boundary, SurfaceContacts& contacts,
                      StepEnd chosen_at, const QueryLimits& limits) {
    resize(contacts, x.rows());
    m_impl->prepare(boundary, chosen_at, size_t(x.rows()));
    m_impl->for_each_nearest(x, nullptr, boundary, limits, [&](int i, const Nearest& nearest) {
        store_row(nearest, chosen_at, limits, i, contacts);
    });
}

void Proximity::query_rows(const Points& x, const std::vector<int>& rows, const Boundary& boundary,
                           SurfaceContacts& contacts, StepEnd chosen_at,
                           const QueryLimits& limits) {
    if (rows.empty()) return;
    m_impl->prepare(boundary, chosen_at, size_t(x.rows()));
    m_impl->for_each_nearest(x, &rows, boundary, limits, [&](int i, const Nearest& nearest) {
        store_row(nearest, chosen_at, limits, i, contacts);
    });
}

std::optional<Cover> Proximity::cover(const SurfaceContacts& contacts, Eigen::Index i,
                                      StepEnd chosen_at, LimbSet ignored) {
    return m_impl->cover(contacts, i, chosen_at, ignored, m_impl->stacks[0]);
}

void Proximity::cover_rows(const Boundary& boundary, const SurfaceContacts& contacts,
                           const std::vector<int>& rows, StepEnd end,
                           const std::vector<LimbSet>& ignored,
                           std::vector<std::optional<Cover>>& covers) {
    m_impl->prepare(boundary, end, contacts.obstacle.size());
    const int count = static_cast<int>(rows.size());
    covers.resize(rows.size());
    const int threads = m_impl->threads_for(count);
#pragma omp parallel for num_threads(threads) schedule(dynamic, 32) if (threads > 1)
    for (int k = 0; k < count; ++k) {
        const int i = rows[size_t(k)];
        covers[size_t(k)] = m_impl->cover(contacts, i, end, ignored[size_t(i)],
                                          m_impl->stacks[size_t(omp_get_thread_num())]);
    }
}

void Proximity::signed_distance(const Points& x, const Boundary& boundary, StepEnd end,
                                VectorX& distance) {
    distance.resize(x.rows());
    m_impl->prepare(boundary, end, size_t(x.rows()));
    m_impl->for_each_nearest(x, nullptr, boundary, {}, [&](int i, const Nearest& nearest) {
        distance[i] = nearest.distance;
    });
}

static void check_mesh(const std::string& name, const Obstacle& mesh) {
    if (!mesh.faces || mesh.faces->rows() == 0)
        throw ArgumentError(name, "a mesh obstacle without faces", "set Obstacle::faces");
    if (mesh.x0.rows() != mesh.x1.rows())
        throw ArgumentError(name, "x0 and x1 have different numbers of vertices",
                            "give the same vertices at t and at t + dt");
    if (!faces_in_range(*mesh.faces, mesh.x0.rows()))
        throw ArgumentError(name, "a face refers to a vertex that does not exist",
                            "give x0 and x1 of all vertices, numbered from 0");
    if (mesh.limbs && !has_limbs(mesh))
        throw ArgumentError(name, "has not one limb from 0 to 31 for each face",
                            "give |F| limbs, or leave Obstacle::limbs empty");
    if (!mesh.x0.allFinite() || !mesh.x1.allFinite())
        throw ArgumentError(name, "a vertex is not finite", "check the pose that made it");
}

void check_obstacles(const Boundary& boundary) {
    for (size_t i = 0; i < boundary.obstacles.size(); ++i) {
        const std::string name = "Boundary::obstacles[" + std::to_string(i) + "]";
        const Obstacle& obstacle = boundary.obstacles[i];
        if (obstacle.shape == ObstacleShape::mesh)
            check_mesh(name, obstacle);
        else if (!is_usable_primitive(obstacle))
            throw ArgumentError(name, "a size is negative, or a size or pose is not finite",
                                "check half_extents, radius, pose0 and pose1");
    }
}

}  // namespace cloth
