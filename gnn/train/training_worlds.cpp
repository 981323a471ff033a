#include "gnn/train/training_worlds.h"

#include <algorithm>
#include <iostream>
#include <utility>

#include "data/body/animated_body.h"
#include "data/body/body_shapes.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/mesh_io.h"
#include "gnn/train/sheet_world.h"
#include "gnn/train/tshirt_world.h"

namespace cloth {

namespace {

/// Clips that are kept for validation and reports.
bool is_held_out(const std::string& name) {
    for (const char* held_out : {"01_01", "07_02", "16_35", "14_24"})
        if (name.find(held_out) != std::string::npos) return true;
    return false;
}

std::vector<std::string> training_motions() {
    if (const auto folder = shared_data_path("motions/train")) return list_motions(*folder);
    return {"01_03", "Boxing_Toes"};
}

}  // namespace

struct SceneFactory::Assets {
    std::vector<TriMesh> sheets;
    std::vector<TriMesh> garments;
    std::vector<std::shared_ptr<const ClothGraph>> graphs;  ///< of `garments`
    std::vector<Motion> motions;
    std::shared_ptr<const Body> body;
    std::optional<BodyShapes> shapes;
};

SceneFactory::SceneFactory(const ModelConfig& config, SceneSettings settings, std::uint64_t seed)
    : m_config(config), m_settings(std::move(settings)), m_assets(std::make_unique<Assets>()) {
    check_range("SceneSettings.tshirt_share", m_settings.tshirt_share, 0.0, 1.0);
    check_range("SceneSettings.shape_share", m_settings.shape_share, 0.0, 1.0);
    check_range("SceneSettings.fabric_share", m_settings.fabric_share, 0.0, 1.0);
    check_range("SceneSettings.max_warm_up", m_settings.max_warm_up, 0, 10000);
    for (int size : m_settings.sheet_sizes) check_range("SceneSettings.sheet_sizes", size, 4, 1e5);
    SceneRandom random(seed);
    for (int size : m_settings.sheet_sizes)
        for (int copy = 0; copy < 2; ++copy) {
            const double width = random.uniform(0.4, 0.9), depth = width * random.uniform(0.7, 1.4);
            m_assets->sheets.push_back(
                cloth::make_sheet(width, depth, size, static_cast<unsigned>(random.bits() >> 33)));
        }
    if (m_settings.tshirt_share <= 0.0) return;
    try {
        m_assets->body = std::make_shared<const Body>(Body::load_default());
        for (const std::string& name : m_settings.garments) {
            m_assets->garments.push_back(load_mesh(asset_path(name)));
            const Garment garment(name, m_assets->garments.back(), Fabric::soft_cotton());
            m_assets->graphs.push_back(std::make_shared<const ClothGraph>(
                build_cloth_graph(garment, m_config.graph_settings())));
        }
        if (m_settings.motions.empty()) m_settings.motions = training_motions();
        for (const std::string& name : m_settings.motions)
            if (!is_held_out(name)) m_assets->motions.push_back(load_motion_by_name(name));
        m_assets->shapes = BodyShapes::load_shared();
        if (!m_assets->shapes) std::cerr << "train: no body shapes, the default body is used\n";
    } catch (const std::exception& error) {
        std::cerr << "train: no T-shirt scenes: " << error.what() << "\n";
    }
}

SceneFactory::~SceneFactory() = default;

bool SceneFactory::has_tshirts() const {
    return m_settings.tshirt_share > 0.0 && !m_assets->garments.empty() &&
           !m_assets->motions.empty();
}

static std::unique_ptr<TrainingScene> finish(SceneParts parts, std::uint64_t seed,
                                             const ModelConfig& config) {
    parts.seed = seed;
    if (!parts.graph)
        parts.graph = std::make_shared<const ClothGraph>(
            build_cloth_graph(*parts.garment, config.graph_settings()));
    return std::make_unique<TrainingScene>(std::move(parts), config.features, config.dt);
}

std::unique_ptr<TrainingScene> SceneFactory::make_sheet(std::uint64_t seed) const {
    SceneRandom random(seed);
    const TriMesh& flat =
        m_assets
            ->sheets[static_cast<size_t>(random.below(static_cast<int>(m_assets->sheets.size())))];
    const Fabric fabric =
        random.chance(m_settings.fabric_share) ? random.fabric() : Fabric::soft_cotton();
    return finish(make_sheet_parts(flat, fabric, random), seed, m_config);
}

std::unique_ptr<TrainingScene> SceneFactory::make_tshirt(std::uint64_t seed,
                                                         const std::string& motion,
                                                         size_t garment) const {
    if (m_assets->garments.empty()) return nullptr;
    const size_t which = std::min(garment, m_assets->garments.size() - 1);
    auto animated =
        std::make_shared<const AnimatedBody>(m_assets->body, load_motion_by_name(motion));
    SceneParts parts = make_body_parts(
        std::make_shared<const Garment>("tshirt", m_assets->garments[which], Fabric::soft_cotton()),
        animated, 0.0);
    parts.graph = m_assets->graphs[which];
    return finish(std::move(parts), seed, m_config);
}

std::unique_ptr<TrainingScene> SceneFactory::make(std::uint64_t seed) const {
    SceneRandom random(seed ^ 0x9e3779b97f4a7c15ull);
    if (!has_tshirts() || !random.chance(m_settings.tshirt_share)) return make_sheet(seed);
    const auto& assets = *m_assets;
    const int count = static_cast<int>(assets.garments.size());
    const size_t which = static_cast<size_t>(random.below(count));
    const Motion& whole =
        assets.motions[static_cast<size_t>(random.below(static_cast<int>(assets.motions.size())))];
    const Motion motion = motion_from(whole, random.below(whole.frame_count()), 30);
    const Fabric fabric =
        random.chance(m_settings.fabric_share) ? random.fabric() : Fabric::soft_cotton();
    TriMesh rest = assets.garments[which];
    std::shared_ptr<const Body> body = assets.body;
    std::shared_ptr<const ClothGraph> graph = assets.graphs[which];
    if (assets.shapes && random.chance(m_settings.shape_share)) {
        body = std::make_shared<const Body>(
            assets.body->with_rest(assets.shapes->skin(sample_body_shape(random.bits()))));
        rest.vertices = carry_garment(rest.vertices, assets.body->rest(), body->rest());
        graph = nullptr;
    }
    const auto animated = std::make_shared<const AnimatedBody>(body, motion);
    SceneParts parts =
        make_body_parts(std::make_shared<const Garment>("tshirt", std::move(rest), fabric),
                        animated, random.uniform(0.0, 2.0 * M_PI));
    parts.graph = graph;
    parts.warm_up = random.below(m_settings.max_warm_up + 1);
    const int frames = animated->frame_count(m_config.dt) - parts.warm_up;
    parts.life = std::max(5, std::min(frames, 30 + random.below(60)));
    return finish(std::move(parts), seed, m_config);
}

}  // namespace cloth
