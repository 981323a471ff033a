// Nearest points of a garment on a moving body: cost per frame of refit and query.
//
//     build/release/tests/bench/collision_bench
//
// The body is the project's default body (26,756 faces; without assimp-testmodels a torus of as
// many faces). It twists and leans smoothly, 0.5 m/s at the most; the query points are 5 to 25 mm
// off its trunk and arms, as a shirt's vertices are, and slide over it.

#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "collision/proximity/brute_force.h"
#include "collision/proximity/proximity.h"
#include "collision/response/resolve.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/mesh_io.h"
#include "tests/test_meshes.h"

namespace cloth {
namespace {

TriMesh body_mesh() {
    try {
        return load_mesh(model_path("Collada/human.zae"), "human-baseMesh");
    } catch (const LoadError&) {
        TriMesh torus = test::torus(178, 75, 0.5, 0.15);
        torus.vertices.col(1).array() += 0.9;
        return torus;
    }
}

/// Every point turned around the y axis, and leaned, by an angle that grows with its height.
Points moved(const Points& points, int frame) {
    const double phase = 2 * M_PI * frame / 60.0;
    Points result(points.rows(), 3);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        const double height = points(i, 1);
        const double turn = 0.4 * std::sin(phase) * height, lean = 0.05 * std::cos(phase) * height;
        result.row(i) << points(i, 0) * std::cos(turn) + points(i, 2) * std::sin(turn) + lean,
            height, points(i, 2) * std::cos(turn) - points(i, 0) * std::sin(turn);
    }
    return result;
}

/// Points above random faces between hip and neck.
Points garment_points(const TriMesh& body, Eigen::Index count) {
    std::mt19937 random(7);
    const Points normals = face_normals(body.vertices, body.faces);
    Points points(count, 3);
    for (Eigen::Index i = 0; i < count;) {
        const auto face = static_cast<Eigen::Index>(random() % size_t(body.faces.rows()));
        const Vec3 x = body.vertices.row(body.faces(face, 0));
        if (x.y() < 0.8 || x.y() > 1.4 || std::abs(x.x()) > 0.45) continue;
        points.row(i++) = x + test::uniform(random, 5e-3, 25e-3) * normals.row(face).transpose();
    }
    return points;
}

/// Sixty frames of body and points: a cycle, so a benchmark may run on for ever.
struct Scene {
    static constexpr int frame_count = 60;
    std::vector<Boundary> boundaries;
    std::vector<Points> points;

    explicit Scene(Eigen::Index count) {
        const TriMesh body = body_mesh();
        const Points start = garment_points(body, count);
        const auto faces = std::make_shared<const Faces>(body.faces);
        for (int frame = 0; frame < frame_count; ++frame) {
            Obstacle obstacle;
            obstacle.faces = faces;
            obstacle.x0 = moved(body.vertices, frame);
            obstacle.x1 = moved(body.vertices, frame + 1);
            boundaries.emplace_back();
            boundaries.back().obstacles.push_back(obstacle);
            points.push_back(moved(start, frame));
        }
    }
};

const Scene& scene(Eigen::Index count) {
    static const Scene small(4000), large(12000);
    return count == 4000 ? small : large;
}

void report_per_query(benchmark::State& state, Eigen::Index count) {
    state.counters["per_query"] = benchmark::Counter(
        static_cast<double>(count),
        benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// Refit and query of a whole frame, as a stepper asks for it.
void frame(benchmark::State& state) {
    const Scene& all = scene(state.range(0));
    Proximity proximity({0.1, static_cast<int>(state.range(1))});
    SurfaceContacts contacts;
    size_t at = 0;
    for (auto _ : state) {
        proximity.query(all.points[at], all.boundaries[at], contacts);
        benchmark::DoNotOptimize(contacts.distance.data());
        at = (at + 1) % Scene::frame_count;
    }
    report_per_query(state, state.range(0));
}

/// The points move, the body does not: queries without refit.
void queries_only(benchmark::State& state) {
    const Scene& all = scene(state.range(0));
    Proximity proximity({0.1, static_cast<int>(state.range(1))});
    SurfaceContacts contacts;
    size_t at = 0;
    for (auto _ : state) {  // one frame's motion forth and back
        proximity.query(all.points[at % 2], all.boundaries[0], contacts);
        benchmark::DoNotOptimize(contacts.distance.data());
        ++at;
    }
    report_per_query(state, state.range(0));
}

/// One point only: what is left is the refit.
void refit_only(benchmark::State& state) {
    const Scene& all = scene(4000);
    Proximity proximity({0.1, 1});
    SurfaceContacts contacts;
    const Points x = all.points[0].topRows(1);
    size_t at = 0;
    for (auto _ : state) {
        proximity.query(x, all.boundaries[at], contacts);
        at = (at + 1) % Scene::frame_count;
    }
}

/// First query of a body: FCL builds its hierarchy.
void build(benchmark::State& state) {
    const Scene& all = scene(4000);
    const Points x = all.points[0].topRows(1);
    SurfaceContacts contacts;
    for (auto _ : state) {
        Proximity proximity;
        proximity.query(x, all.boundaries[0], contacts);
    }
}

void resolve(benchmark::State& state) {
    const Scene& all = scene(4000);
    Proximity proximity({0.1, 1});
    SurfaceContacts contacts;
    size_t at = 0;
    for (auto _ : state) {
        Points x = all.points[at];  // a frame late: part of it is inside
        resolve_penetration(proximity, all.boundaries[at], 1e-3, x, contacts);
        at = (at + 1) % Scene::frame_count;
    }
}

void brute_force(benchmark::State& state) {
    const Scene& all = scene(4000);
    const TriMesh body{all.boundaries[0].obstacles[0].x0, *all.boundaries[0].obstacles[0].faces};
    Eigen::Index at = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(brute_force_closest(body, all.points[0].row(at).transpose()));
        at = (at + 1) % 4000;
    }
    report_per_query(state, 1);
}

// One thread is measured in CPU time, which other programs disturb least; two in wall time.
#define CLOTH_QUERY_BENCHMARK(function)   \
    BENCHMARK(function)                   \
        ->Args({4000, 1})                 \
        ->Args({12000, 1})                \
        ->ArgNames({"points", "threads"}) \
        ->Unit(benchmark::kMillisecond);  \
    BENCHMARK(function)                   \
        ->Args({4000, 2})                 \
        ->Args({12000, 2})                \
        ->ArgNames({"points", "threads"}) \
        ->Unit(benchmark::kMillisecond)   \
        ->UseRealTime()
CLOTH_QUERY_BENCHMARK(frame);
CLOTH_QUERY_BENCHMARK(queries_only);
BENCHMARK(refit_only)->Unit(benchmark::kMillisecond);
BENCHMARK(build)->Unit(benchmark::kMillisecond);
BENCHMARK(resolve)->Unit(benchmark::kMillisecond);
BENCHMARK(brute_force)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace cloth

BENCHMARK_MAIN();
