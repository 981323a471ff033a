#include "collision/proximity/obstacle_trees.h"

#include <cmath>
#include <cstring>
#include <vector>

#include "collision/geometry/faces_in_range.h"
#include "collision/geometry/motion_tree.h"
#include "collision/proximity/mesh_surface.h"
#include "collision/proximity/tree_fits.h"
#include "data/core/check_range.h"

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

struct ObstacleTrees::Impl {
    ObstacleTreesSettings settings;
    mutable std::mutex mutex;  // of all that follows
    long step = 0;
    Counts counts;
    std::vector<KnownMesh> meshes;

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
            FittedMotion{MotionTree(mesh.x0, *mesh.faces), {}, {}});
    }
};

ObstacleTrees::ObstacleTrees(const ObstacleTreesSettings& settings)
    : m_impl(std::make_unique<Impl>()) {
    if (!(settings.radius > 0.0) || !std::isfinite(settings.radius))
        throw ArgumentError("ObstacleTreesSettings.radius", "it is not positive and finite",
                            "give the largest radius of queries (m)");
    check_range("ObstacleTreesSettings.forget_after", settings.forget_after, 1, 1e6);
    m_impl->settings = settings;
}

ObstacleTrees::~ObstacleTrees() = default;

const ObstacleTreesSettings& ObstacleTrees::settings() const {
    return m_impl->settings;
}

void ObstacleTrees::begin_step() {
    const std::lock_guard<std::mutex> lock(m_impl->mutex);
    ++m_impl->step;
    std::vector<KnownMesh>& meshes = m_impl->meshes;
    const auto is_forgotten = [&](const KnownMesh& mesh) {
        return m_impl->step - mesh.last_step > m_impl->settings.forget_after;
    };
    meshes.erase(std::remove_if(meshes.begin(), meshes.end(), is_forgotten), meshes.end());
}

std::shared_ptr<const MeshSurface> ObstacleTrees::surface(const Obstacle& obstacle, StepEnd end) {
    if (!is_mesh(obstacle)) return nullptr;
    const Points& x = end == StepEnd::start ? obstacle.x0 : obstacle.x1;
    const std::lock_guard<std::mutex> lock(m_impl->mutex);
    KnownMesh* mesh = m_impl->find(obstacle);
    if (!mesh) return nullptr;
    const auto is_here = [&](const MeshSurface& surface) {
        return are_same(surface.vertices(), x);
    };
    if (auto known = mesh->surfaces.find(m_impl->step, is_here)) return known;
    std::unique_ptr<MeshSurface> surface = mesh->surfaces.take(m_impl->step);
    if (!surface) surface = m_impl->build_surface(obstacle);
    surface->refit(x);
    ++m_impl->counts.surface_fits;
    return mesh->surfaces.add(m_impl->step, std::move(surface));
}

std::shared_ptr<const MotionTree> ObstacleTrees::motion(const Obstacle& obstacle) {
    if (!is_mesh(obstacle)) return nullptr;
    const std::lock_guard<std::mutex> lock(m_impl->mutex);
    KnownMesh* mesh = m_impl->find(obstacle);
    if (!mesh) return nullptr;
    const auto is_it = [&](const FittedMotion& motion) {
        return are_same(motion.x0, obstacle.x0) && are_same(motion.x1, obstacle.x1);
    };
    auto found = mesh->motions.find(m_impl->step, is_it);
    if (!found) {
        if (!obstacle.x0.allFinite() || !obstacle.x1.allFinite()) return nullptr;
        std::unique_ptr<FittedMotion> motion = mesh->motions.take(m_impl->step);
        if (!motion) motion = m_impl->build_motion(obstacle);
        motion->fit(obstacle);
        ++m_impl->counts.motion_fits;
        found = mesh->motions.add(m_impl->step, std::move(motion));
    }
    return {found, &found->tree};
}

ObstacleTrees::Counts ObstacleTrees::counts() const {
    const std::lock_guard<std::mutex> lock(m_impl->mutex);
    return m_impl->counts;
}

int ObstacleTrees::meshes() const {
    const std::lock_guard<std::mutex> lock(m_impl->mutex);
    return static_cast<int>(m_impl->meshes.size());
}

}  // namespace cloth
