// bake: a garment on a moving body, written frame by frame to a cache that modellers read.
#include <omp.h>

#include <csignal>
#include <cstdio>
#include <stdexcept>

#include "data/files/cache_format.h"
#include "demos/bake/bake.h"
#include "demos/compare/command_line.h"
#include "demos/compare/progress.h"
#include "demos/compare/solver_factory.h"

using namespace cloth;

namespace {

volatile std::sig_atomic_t interrupted = 0;

/// The first Ctrl-C lets the frame that is computed end, the second ends the program at once.
void end_after_this_frame() {
    struct sigaction action {};
    action.sa_handler = [](int) { interrupted = 1; };
    action.sa_flags = SA_RESETHAND;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

void tell_scene(const BakeScene& scene, const BakeOptions& options) {
    std::printf("%s, %d vertices, %d frames at %d Hz, by %s\n", options.garment.c_str(),
                static_cast<int>(scene.cloth->garment().vertex_count()), scene.frames(),
                options.rate, options.solver.c_str());
    for (const std::string& note : scene.notes) std::printf("%s\n", note.c_str());
    if (options.frames > scene.frames())
        std::printf("--frames %d: the motion has no more than %d\n", options.frames,
                    scene.frames());
    if (options.resume) std::printf("frames that are there are computed again, and compared\n");
}

void run(const BakeOptions& options) {
    const BakeScene scene = make_bake_scene(options);
    const auto stepper = make_solver(options.solver, *scene.cloth, {{}, options.threads, nullptr});
    std::vector<BakedMesh> meshes = open_caches(scene, options);
    tell_scene(scene, options);
    Progress line;
    std::string problem;
    const bool whole =
        bake(scene, *stepper, meshes,
             {[&line](int done, int all, const std::string& what) { line.update(done, all, what); },
              [] { return interrupted != 0; },
              [&](int frame, const std::string& what) {
                  const bool is_last = frame + 1 == scene.frames();
                  problem = (frame < 0 ? "before the first frame"
                             : is_last ? "in the last frame"
                                       : "from frame " + std::to_string(frame) + " on") +
                            std::string(": ") + what;
              }});
    if (!whole)
        throw std::runtime_error("\ninterrupted at frame " +
                                 std::to_string(meshes[0].cache->frames()) + " of " +
                                 std::to_string(scene.frames()) + "; what is there is in " +
                                 (cache_format(options.out) == CacheFormat::obj_sequence
                                      ? options.out
                                      : unfinished_cache(options.out)) +
                                 "; the same command with --resume goes on");
    for (const BakedMesh& mesh : meshes)
        std::printf("%s, of the mesh %s\n", mesh.cache->path().c_str(),
                    rest_file(mesh.cache->path()).c_str());
    if (!problem.empty()) throw std::runtime_error(problem);
}

}  // namespace

int main(int argc, char** argv) {
    return run_program(argc, argv, [](const std::vector<std::string>& arguments) {
        const BakeOptions options = parse_bake_options(arguments);
        end_after_this_frame();
        if (options.threads > 0) omp_set_num_threads(options.threads);
        run(options);
    });
}
