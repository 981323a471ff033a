#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "data/files/cache_writer.h"
#include "demos/bake/bake_scene.h"
#include "demos/bake/options.h"
#include "gnn/stepper.h"

namespace cloth {

/// A cache, and what gives its frames their vertices.
struct BakedMesh {
    std::unique_ptr<CacheWriter> cache;
    std::function<Points(const ClothState&, double time)> positions;
};

/// The caches that the options ask for, and beside each the mesh that it belongs to, rest_file().
/// @throws LoadError, ArgumentError if a file cannot be written; UsageError if there is nothing to
///         resume
std::vector<BakedMesh> open_caches(const BakeScene& scene, const BakeOptions& options);

/// NAME_rest.obj of NAME.pc2, or of the folder NAME.
std::string rest_file(const std::string& cache);

/// All that is written for a cache: itself, what it is called until it is whole, and rest_file().
std::vector<std::string> cache_files(const std::string& cache);

/// What a run needs to know of its surroundings.
struct BakeWatch {
    std::function<void(int done, int all, const std::string& what)> progress;
    std::function<bool()> interrupted;  ///< asked before each step
    /// Told once, when the scene says that the garment is lost, or at the end worn_problem() does;
    /// may be null.
    std::function<void(int frame, const std::string& problem)> lost = nullptr;
};

/// Steps the garment through the lead-in and the motion, writes every frame, and finishes the
/// caches. Solvers remember more than positions and velocities, so a run that is resumed computes
/// its frames again: the caches compare them with what is there.
/// @return  false: it was interrupted, and the caches are unfinished
/// @throws std::runtime_error if a step failed, LoadError if a frame cannot be written
bool bake(const BakeScene& scene, Stepper& stepper, std::vector<BakedMesh>& meshes,
          const BakeWatch& watch);

}  // namespace cloth
