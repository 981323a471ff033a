#include "gnn/train/training_worlds.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <utility>

#include "data/body/animated_body.h"
#include "data/body/body_shapes.h"
#include "data/core/carry_over.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/garment_assets.h"
#include "gnn/train/body_world.h"
#include "gnn/train/sheet_world.h"

namespace cloth {

namespace {

/// Clips that are kept for validation and reports, by the names of their files.
bool is_held_out(const std::string& clip) {
    const std::string name = std::filesystem::path(clip).filename().string();
    for (const char* held_out : {"01_01", "07_02", "16_35", "14_24"})
        if (name.find(held_out) != std::string::npos) return true;
    return false;
}

void warn_of_named_shared_data() {
    const char* const folder = std::getenv("CLOTH_SHARED_DATA");
    if (folder == nullptr || *folder == '\0') return;
    const bool is_folder = std::filesystem::is_directory(folder);
    std::cerr << "train: CLOTH_SHARED_DATA is " << folder << ", which "
              << (is_folder ? "has no folder motions/train" : "is no folder")
              << ": the two clips of assimp-testmodels are trained on instead\n";
}

ClothState not_moving(const Points& x) {
    return {x, Points::Zero(x.rows(), 3), 0.0};
}

}  // namespace

std::vector<std::string> training_motions() {
    const auto folder = shared_data_path("motions/train");
    if (!folder) {
        warn_of_named_shared_data();
        return {"01_03", "Boxing_Toes"};
    }
    std::vector<std::string> motions = list_motions(*folder);
    motions.erase(std::remove_if(motions.begin(), motions.end(), is_held_out), motions.end());
    if (motions.empty())
        throw LoadError(*folder, "", "has no motion to train on",
                        "put BVH files there; names with 01_01, 07_02, 16_35 or 14_24 are kept for "
                        "validation");
    return motions;
}

std::vector<std::string> training_garments() {
    return {"long_top_1000", "long_top",    "shirt_1000",  "shirt",       "pants_1000",
            "pants",         "shorts_1000", "shorts",      "skirt_1000",  "skirt",
            "dress_1000",    "dress_4000",  "tshirt_1000", "tshirt_2000", "tshirt"};
}

std::vector<std::string> proxied_garments() {
    return {"long_top", "shirt", "pants", "shorts", "skirt", "dress_4000", "tshirt_2000", "tshirt"};
}

/// The coarse garment of the same cut; empty: there is none.
static std::string proxy_of(const std::string& garment) {
    const std::vector<std::string> names = proxied_garments();
    if (std::find(names.begin(), names.end(), garment) == names.end()) return "";
    return garment.substr(0, garment.find_last_not_of("_0123456789") + 1) + "_1000";
}

void SceneSettings::check() const {
    check_range("SceneSettings.garment_share", garment_share, 0.0, 1.0);
    check_range("SceneSettings.shape_share", shape_share, 0.0, 1.0);
    check_range("SceneSettings.fabric_share", fabric_share, 0.0, 1.0);
    check_range("SceneSettings.sheet_sizes", static_cast<double>(sheet_sizes.size()), 1, 100);
    for (const int size : sheet_sizes) check_range("SceneSettings.sheet_sizes", size, 9, 200000);
    check_range("SceneSettings.max_warm_up", max_warm_up, 0, 1000);
    skinned.check();
}

struct SceneFactory::Assets {
    std::vector<TriMesh> sheets;
    /// What all scenes of a garment on the default body share.
    struct Wardrobe {
        std::string name;
        TriMesh rest;
        Points worn;  ///< |V| x 3 (m)
        std::shared_ptr<const ClothGraph> graph;
        std::optional<TriMesh> proxy = std::nullopt;  ///< at rest
        Points proxy_worn = {};
    };

    std::vector<Wardrobe> garments;
    std::vector<Motion> motions;
    std::shared_ptr<const Body> body;
    std::optional<BodyShapes> shapes;
};

SceneFactory::SceneFactory(const ModelConfig& config, SceneSettings settings, std::uint64_t seed)
    : m_config(config), m_settings(std::move(settings)), m_assets(std::make_unique<Assets>()) {
    SceneRandom random(seed);
    for (int size : m_settings.sheet_sizes)
        for (int copy = 0; copy < 2; ++copy) {
            const double width = random.uniform(0.4, 0.9), depth = width * random.uniform(0.7, 1.4);
            m_assets->sheets.push_back(
                cloth::make_sheet(width, depth, size, static_cast<unsigned>(random.bits() >> 33)));
        }
    if (m_settings.garment_share > 0.0) load_assets();
}

void SceneFactory::load_assets() {
    m_assets->body = std::make_shared<const Body>(Body::load_default());
    for (const std::string& name : m_settings.garments) {
        const Garment garment = load_garment(name);
        m_assets->garments.push_back({name, garment.rest(), load_garment_start(name).x,
                                      std::make_shared<const ClothGraph>(
                                          build_cloth_graph(garment, m_config.graph_settings()))});
        const std::string proxy = m_settings.proxies ? proxy_of(name) : "";
        if (proxy.empty()) continue;
        m_assets->garments.back().proxy = load_garment(proxy).rest();
        m_assets->garments.back().proxy_worn = load_garment_start(proxy).x;
    }
    if (m_settings.motions.empty()) m_settings.motions = training_motions();
    for (const std::string& name : m_settings.motions)
        if (!is_held_out(name)) m_assets->motions.push_back(load_motion_by_name(name));
    const char* const remedy = "name one, or train on sheets alone: garment_share 0";
    if (m_assets->garments.empty())
        throw ArgumentError("SceneSettings.garments", "has none", remedy);
    if (m_assets->motions.empty())
        throw ArgumentError("SceneSettings.motions", "has none but those of validation", remedy);
    m_assets->shapes = BodyShapes::load_shared();
    if (!m_assets->shapes) std::cerr << "train: no body shapes, the default body is used\n";
}

static std::shared_ptr<const Garment> proxy_garment(const Garment& garment, const TriMesh& rest) {
    return std::make_shared<const Garment>(carry_over(garment, rest, garment.name() + " proxy"));
}

SceneFactory::~SceneFactory() = default;

bool SceneFactory::has_garments() const {
    return m_settings.garment_share > 0.0 && !m_assets->garments.empty() &&
           !m_assets->motions.empty();
}

std::vector<std::string> SceneFactory::garment_names() const {
    std::vector<std::string> names;
    for (const Assets::Wardrobe& garment : m_assets->garments) names.push_back(garment.name);
    return names;
}

std::unique_ptr<TrainingScene> SceneFactory::finish(SceneParts parts, std::uint64_t seed) const {
    parts.seed = seed;
    if (!parts.graph)
        parts.graph = std::make_shared<const ClothGraph>(
            build_cloth_graph(*parts.garment, m_config.graph_settings()));
    return std::make_unique<TrainingScene>(std::move(parts), m_config.features, m_config.dt);
}

std::unique_ptr<TrainingScene> SceneFactory::make_sheet(std::uint64_t seed) const {
    SceneRandom random(seed);
    const TriMesh& flat =
        m_assets
            ->sheets[static_cast<size_t>(random.below(static_cast<int>(m_assets->sheets.size())))];
    const Fabric fabric =
        random.chance(m_settings.fabric_share) ? random.fabric() : Fabric::soft_cotton();
    return finish(make_sheet_parts(flat, fabric, random), seed);
}

std::unique_ptr<TrainingScene> SceneFactory::make_garment(std::uint64_t seed,
                                                          const std::string& motion,
                                                          size_t garment) const {
    if (m_assets->garments.empty()) return nullptr;
    const Assets::Wardrobe& piece =
        m_assets->garments[std::min(garment, m_assets->garments.size() - 1)];
    auto animated =
        std::make_shared<const AnimatedBody>(m_assets->body, load_motion_by_name(motion));
    SceneParts parts = make_body_parts(
        std::make_shared<const Garment>(piece.name, piece.rest, Fabric::soft_cotton()), animated,
        0.0, not_moving(piece.worn));
    parts.graph = piece.graph;
    if (piece.proxy) parts.proxy = proxy_garment(*parts.garment, *piece.proxy);
    return finish(std::move(parts), seed);
}

std::unique_ptr<TrainingScene> SceneFactory::make(std::uint64_t seed) const {
    SceneRandom random(seed ^ 0x9e3779b97f4a7c15ull);
    if (!has_garments() || !random.chance(m_settings.garment_share)) return make_sheet(seed);
    const auto& assets = *m_assets;
    const int count = static_cast<int>(assets.garments.size());
    const Assets::Wardrobe& piece = assets.garments[static_cast<size_t>(random.below(count))];
    const Motion& whole =
        assets.motions[static_cast<size_t>(random.below(static_cast<int>(assets.motions.size())))];
    const Motion motion = motion_from(whole, random.below(whole.frame_count()), 30);
    const Fabric fabric =
        random.chance(m_settings.fabric_share) ? random.fabric() : Fabric::soft_cotton();
    TriMesh rest = piece.rest;
    Points worn = piece.worn;
    std::optional<TriMesh> proxy = piece.proxy;
    std::shared_ptr<const Body> body = assets.body;
    std::shared_ptr<const ClothGraph> graph = piece.graph;
    if (assets.shapes && random.chance(m_settings.shape_share)) {
        body = std::make_shared<const Body>(
            assets.body->with_rest(assets.shapes->skin(sample_body_shape(random.bits()))));
        const Points carried = carried_along(worn, assets.body->rest(), body->rest());
        rest.vertices += carried;
        worn += carried;
        if (proxy)
            proxy->vertices += carried_along(piece.proxy_worn, assets.body->rest(), body->rest());
        graph = nullptr;
    }
    const auto animated = std::make_shared<const AnimatedBody>(body, motion);
    const auto garment = std::make_shared<const Garment>(piece.name, std::move(rest), fabric);
    const double yaw = random.uniform(0.0, 2.0 * M_PI);
    const int warm_up = random.below(m_settings.max_warm_up + 1);
    const int longest = 30 + random.below(60);
    const int frames = animated->frame_count(m_config.dt);
    const bool skinned = m_settings.skinned.share > 0.0 && random.chance(m_settings.skinned.share);
    const int first = skinned ? random.below(std::max(1, frames - 30)) : warm_up;
    ClothState start = skinned ? skinned_start(*garment, worn, *animated, m_settings.skinned,
                                               first * m_config.dt, m_config.dt, random)
                               : not_moving(worn);
    SceneParts parts = make_body_parts(garment, animated, yaw, std::move(start));
    if (!skinned) parts.warm_up = warm_up;
    parts.graph = graph;
    if (proxy) parts.proxy = proxy_garment(*garment, *proxy);
    parts.life = std::max(5, std::min(frames - first, longest));
    return finish(std::move(parts), seed);
}

}  // namespace cloth
