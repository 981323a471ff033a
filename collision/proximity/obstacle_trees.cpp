#include "collision/proximity/obstacle_trees.h"

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "collision/geometry/faces_in_range.h"
#include "collision/geometry/motion_tree.h"
#include "collision/proximity/mesh_surface.h"
#include "collision/proximity/tree_fits.h"

namespace cloth {
namespace {

/// A motion, and the tree that was fitted to it.
struct FittedMotion {
    MotionTree tree;
    Points x0, x1;

    void fit(const Obstacle& mesh) {
        x0 = mesh.x0;
        x1 = mesh.x1;
        tree.refit(x0, x1 - x0);
    }
};

struct KnownMesh {
    std::shared_ptr<const Faces> faces;  // held, so that the pointer stays a key
    std::shared_ptr<const std::vector<std::uint8_t>> limbs;
    Eigen::Index vertex_count;
    bool is_usable;
    long last_step;
    TreeFits<MeshSurface> surfaces;
    TreeFits<FittedMotion> motions;
};

bool is_mesh(const Obstacle& obstacle) {
    return obstacle.shape == ObstacleShape::mesh && obstacle.faces &&
           obstacle.x0.rows() == obstacle.x1.rows();
}

bool are_same(const Points& a, const Points& b) {
    return a.rows() == b.rows() &&
           std::memcmp(a.data(), b.data(), static_cast<size_t>(a.size()) * sizeof(double)) == 0;
}

}  // namespace

struct ObstacleTrees::KnownMeshes : Meshes {
    explicit KnownMeshes(const ObstacleTreesSettings& asked) : settings(asked) {}

    void begin_step() override {
        ++step;
        const auto is_forgotten = [&](const KnownMesh& mesh) {
            return step - mesh.last_step > settings.forget_after;
        };
        meshes.erase(std::remove_if(meshes.begin(), meshes.end(), is_forgotten), meshes.end());
    }

    /// Null: the mesh is unusable.
    KnownMesh* find(const Obstacle& mesh) {
        for (KnownMesh& known : meshes)
            if (known.faces == mesh.faces && known.limbs == mesh.limbs &&
                known.vertex_count == mesh.x0.rows()) {
                known.last_step = step;
                return known.is_usable ? &known : nullptr;
            }
        const bool is_usable = faces_in_range(*mesh.faces, mesh.x0.rows());
        meshes.push_back({mesh.faces, mesh.limbs, mesh.x0.rows(), is_usable, step, {}, {}});
        return is_usable ? &meshes.back() : nullptr;
    }

    /// Always of the pose at t: which vertices coincide must not depend on who asks first.
    std::unique_ptr<MeshSurface> build_surface(const Obstacle& mesh) {
        ++counts.builds;
        return std::make_unique<MeshSurface>(mesh.faces, mesh.x0, settings.radius,
                                             mesh.limbs.get());
    }

    std::unique_ptr<FittedMotion> build_motion(const Obstacle& mesh) {
        ++counts.builds;
        return std::make_unique<FittedMotion>(
            FittedMotion{MotionTree(mesh.x0, *mesh.faces), mesh.x0, mesh.x0});
    }

    std::shared_ptr<const MeshSurface> surface(const Obstacle& obstacle, const Points& x) {
        KnownMesh* mesh = find(obstacle);
        if (!mesh) return nullptr;
        const auto is_here = [&](const MeshSurface& surface) {
            return are_same(surface.vertices(), x);
        };
        if (auto known = mesh->surfaces.find(step, is_here)) return known;
        std::unique_ptr<MeshSurface> surface = mesh->surfaces.take(step);
        if (!surface) surface = build_surface(obstacle);
        surface->refit(x);
        ++counts.surface_fits;
        return mesh->surfaces.add(step, std::move(surface));
    }

    std::shared_ptr<const FittedMotion> motion(const Obstacle& obstacle) {
        KnownMesh* mesh = find(obstacle);
        if (!mesh) return nullptr;
        const auto is_it = [&](const FittedMotion& motion) {
            return are_same(motion.x0, obstacle.x0) && are_same(motion.x1, obstacle.x1);
        };
        if (auto known = mesh->motions.find(step, is_it)) return known;
        if (!obstacle.x0.allFinite() || !obstacle.x1.allFinite()) return nullptr;
        std::unique_ptr<FittedMotion> motion = mesh->motions.take(step);
        if (!motion) motion = build_motion(obstacle);
        motion->fit(obstacle);
        ++counts.motion_fits;
        return mesh->motions.add(step, std::move(motion));
    }

    void prepare_motion(const Obstacle& obstacle) {
        KnownMesh* mesh = find(obstacle);
        if (mesh && mesh->motions.is_empty() && obstacle.x0.allFinite())
            mesh->motions.prepare(build_motion(obstacle));
    }

    void adopt(KnownMeshes& other, const Obstacle& obstacle) {
        KnownMesh* mine = find(obstacle);
        KnownMesh* theirs = other.find(obstacle);
        if (!mine || !theirs) return;
        if (mine->surfaces.is_empty())  // one that has a pose, which may be asked for
            if (auto copy = theirs->surfaces.copy()) mine->surfaces.add(step, std::move(copy));
        if (mine->motions.is_empty())
            if (auto copy = theirs->motions.copy()) mine->motions.prepare(std::move(copy));
    }

    ObstacleTreesSettings settings;
    long step = 0;
    Counts counts;
    std::vector<KnownMesh> meshes;
};

ObstacleTrees::KnownMeshes& ObstacleTrees::known() {
    if (!m_meshes) m_meshes = std::make_unique<KnownMeshes>(m_settings);
    return static_cast<KnownMeshes&>(*m_meshes);
}

std::shared_ptr<const MeshSurface> ObstacleTrees::surface(const Obstacle& obstacle, StepEnd end) {
    if (!is_mesh(obstacle)) return nullptr;
    const std::lock_guard<std::mutex> lock(m_mutex);
    return known().surface(obstacle, end == StepEnd::start ? obstacle.x0 : obstacle.x1);
}

std::shared_ptr<const MotionTree> ObstacleTrees::motion(const Obstacle& obstacle) {
    if (!is_mesh(obstacle)) return nullptr;
    const std::lock_guard<std::mutex> lock(m_mutex);
    const std::shared_ptr<const FittedMotion> motion = known().motion(obstacle);
    return motion ? std::shared_ptr<const MotionTree>(motion, &motion->tree) : nullptr;
}

void ObstacleTrees::prepare_motion(const Obstacle& obstacle) {
    if (!is_mesh(obstacle)) return;
    const std::lock_guard<std::mutex> lock(m_mutex);
    known().prepare_motion(obstacle);
}

void ObstacleTrees::adopt(ObstacleTrees& other, const Obstacle& obstacle) {
    if (&other == this || other.m_settings.radius != m_settings.radius || !is_mesh(obstacle))
        return;
    const std::scoped_lock lock(m_mutex, other.m_mutex);
    known().adopt(other.known(), obstacle);
}

ObstacleTrees::Counts ObstacleTrees::counts() const {
    const std::lock_guard<std::mutex> lock(m_mutex);
    return m_meshes ? static_cast<const KnownMeshes&>(*m_meshes).counts : Counts();
}

int ObstacleTrees::meshes() const {
    const std::lock_guard<std::mutex> lock(m_mutex);
    return m_meshes ? static_cast<int>(static_cast<const KnownMeshes&>(*m_meshes).meshes.size())
                    : 0;
}

}  // namespace cloth
