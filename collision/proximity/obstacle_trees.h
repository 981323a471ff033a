#pragma once

#include <memory>
#include <mutex>

#include "data/core/boundary.h"
#include "data/core/check_range.h"

namespace cloth {

class MeshSurface;
class MotionTree;

struct ObstacleTreesSettings {
    double radius = 0.5;      ///< the largest radius of queries (m), 1e-6 to 1e6
    int forget_after = 1000;  ///< steps until a mesh that none shows is forgotten, 1 to 1e6
};

/// The bounding volume hierarchies of a world's mesh obstacles: built once, fitted once to each
/// pose, used by all garments.
///
///     auto trees = std::make_shared<ObstacleTrees>();
///     while (...) {
///         trees->begin_step();
///         boundary.trees = trees;  // of each garment
///         ... step all garments, in one thread or in several ...
///     }
///
/// A pose is known again by its vertices, compared bit for bit: what is returned depends on the
/// arguments alone. Where a step begins as the last one ended, a moving mesh costs one fit a step,
/// whatever the number of garments. Poses of the present step and of the last one are kept; older
/// ones are overwritten unless somebody still holds them. Of a mesh at most 16 are kept, or, where
/// several bodies share it, as many as the last step used: two for each, up to 256. One takes about
/// 0.1 kB for each face, that of a motion 0.2 kB.
///
/// Meshes are told apart by the pointers to their faces and limbs and by their number of vertices.
/// All functions may be called from several threads at once, but begin_step(), which belongs
/// between the steps.
class ObstacleTrees {
 public:
    /// What was done so far. A build has one fit with it.
    struct Counts {
        long builds = 0;        ///< hierarchies that were built: for each mesh one for its surface
                                ///< and, if asked for, one for its motion
        long surface_fits = 0;  ///< surface() of a pose that was not known
        long motion_fits = 0;   ///< motion() between poses that were not known
    };

    /// @throws ArgumentError if a setting is out of range
    explicit ObstacleTrees(const ObstacleTreesSettings& settings = {}) : m_settings(settings) {
        check_range("ObstacleTreesSettings.radius", settings.radius, 1e-6, 1e6);
        check_range("ObstacleTreesSettings.forget_after", settings.forget_after, 1, 1e6);
    }
    ObstacleTrees(const ObstacleTrees&) = delete;
    ObstacleTrees& operator=(const ObstacleTrees&) = delete;

    const ObstacleTreesSettings& settings() const { return m_settings; }

    /// Starts a step: poses of the step before the last are given up.
    void begin_step() {
        const std::lock_guard<std::mutex> lock(m_mutex);
        if (m_meshes) m_meshes->begin_step();
    }

    /// The surface of a mesh obstacle at one end of the step. It stays as it is while it is held.
    /// Null: the obstacle is no mesh, has no faces or some out of range, or x0 and x1 differ in
    /// size. Vertices that are not finite belong to no face.
    std::shared_ptr<const MeshSurface> surface(const Obstacle& obstacle, StepEnd end);

    /// The motion of a mesh obstacle during the step. Null: as surface(), or a vertex is not
    /// finite.
    std::shared_ptr<const MotionTree> motion(const Obstacle& obstacle);

    /// Builds what motion() needs, unless it is there: that takes as long as ten steps. Obstacles
    /// without a motion() are passed over.
    void prepare_motion(const Obstacle& obstacle);

    /// Copies what `other`, made for the same radius, has built for a mesh obstacle and this has
    /// not: much cheaper than to build it.
    void adopt(ObstacleTrees& other, const Obstacle& obstacle);

    Counts counts() const;
    /// Meshes that are kept at present.
    int meshes() const;

 private:
    /// Made when the first mesh is shown. So a world can own an ObstacleTrees, and hand it on,
    /// without linking this library: Bullet's users may bring steppers that do without.
    struct Meshes {
        virtual ~Meshes() = default;
        virtual void begin_step() = 0;
    };
    struct KnownMeshes;
    KnownMeshes& known();

    ObstacleTreesSettings m_settings;
    mutable std::mutex m_mutex;  ///< of what follows
    std::unique_ptr<Meshes> m_meshes;
};

}  // namespace cloth
