#include "demos/bake/character_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "data/body/outfit.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/garment_pieces.h"
#include "data/files/garment_assets.h"
#include "demos/compare/body_scene.h"
#include "demos/dressing_checks.h"

namespace cloth {
namespace {

std::shared_ptr<const WeldedCharacter> character_of(const CharacterSceneSettings& settings) {
    auto skin =
        std::make_shared<const WeldedCharacter>(settings.character, settings.skin, settings.weld);
    check_height(settings.character, *skin);
    check_surface(settings.character, *skin);
    return skin;
}

/// What the user is told of what is painted; nothing if nothing is.
std::vector<std::string> notes_of(const PaintedMesh& painted, const GoalLimits& limits) {
    std::vector<std::string> notes;
    if (painted.unread_colours)
        notes.push_back(
            "the garment has vertex colours, which are not read; --goal-colours reads them as "
            "goals");
    if (limits.empty()) return notes;
    const auto count = [](const auto& condition) {
        return std::to_string(static_cast<long>(condition.count()));
    };
    const double infinity = std::numeric_limits<double>::infinity();
    notes.push_back("goals are painted on it: " + count(limits.max_distance.array() < infinity) +
                    " of its vertices have a largest distance, " +
                    count(limits.backstop.array() < infinity) + " a backstop, " +
                    count(limits.drive_stiffness.array() > 0.0) + " a drive");
    return notes;
}

/// Colours that were asked for and are nowhere would hold nothing.
void check_colours(const CharacterSceneSettings& settings, const std::vector<Garment>& garments) {
    const bool painted = std::any_of(garments.begin(), garments.end(), [](const Garment& garment) {
        return !garment.goal_limits().empty();
    });
    if (settings.goal_colours && !painted)
        throw ArgumentError(settings.garment,
                            "it has no vertex colours, which --goal-colours asks for",
                            "paint them and export them with the mesh, or leave --goal-colours "
                            "out");
}

/// What the user is told of clothes that were not made for this character.
void note_wardrobe(const std::string& garment, std::vector<std::string>& notes) {
    const std::vector<std::string> names = garment_names();
    if (std::find(names.begin(), names.end(), garment) != names.end())
        notes.push_back("it wears " + garment +
                        " of the wardrobe, which is cut for the project's body; give --garment "
                        "FILE for one of its own");
}

/// A garment as its file has it: at rest and as it is worn on the bind pose, which a waistband
/// makes two shapes.
struct ReadGarment {
    Garment rest;
    Points worn;
    std::vector<std::string> notes;
};

ReadGarment read_garment(const CharacterSceneSettings& settings, const std::string& file) {
    const ClothState start = load_garment_start(file);
    PaintedMesh painted = load_painted_garment(file, settings.goal_colours);
    painted.mesh.vertices *= settings.garment_scale;
    WeldedMesh welded = weld_mesh(painted.mesh, settings.weld);
    const GoalLimits limits = welded_limits(painted.limits, welded);
    return {Garment(file, std::move(welded.mesh), fabric_named(settings.fabric)).with_goals(limits),
            settings.garment_scale * start.x(welded.kept, Eigen::all), notes_of(painted, limits)};
}

}  // namespace

struct CharacterScene::WornGarments {
    std::vector<Garment> garments;
    Outfit outfit;  ///< as it is worn on the bind pose
    std::vector<std::string> notes;
};

CharacterScene::WornGarments CharacterScene::read_garments(const CharacterSceneSettings& settings) {
    check_range("--garment-scale", settings.garment_scale, 1e-6, 1e6);
    std::vector<Garment> garments;
    std::vector<Points> worn;
    std::vector<std::string> notes;
    for (const std::string& file : outfit_parts(settings.garment)) {
        ReadGarment read = read_garment(settings, file);
        garments.push_back(std::move(read.rest));
        worn.push_back(std::move(read.worn));
        notes.insert(notes.end(), read.notes.begin(), read.notes.end());
        note_wardrobe(file, notes);
    }
    check_colours(settings, garments);
    MergedGarments merged = merge_garments(settings.garment, garments);
    const Points& rest = merged.garment.rest().vertices;
    Garment garment = merged.garment.with_pins(vertices_between(rest, settings.pin));
    ClothState start = ClothState::at_rest(garment);
    for (size_t k = 0; k < worn.size(); ++k)
        start.x.middleRows(merged.first_vertex[k], worn[k].rows()) = worn[k];
    return {std::move(garments),
            {std::move(garment), std::move(start), std::move(merged.first_vertex)},
            std::move(notes)};
}

CharacterScene::CharacterScene(const CharacterSceneSettings& settings)
    : CharacterScene(settings, character_of(settings), read_garments(settings)) {
}

CharacterScene::CharacterScene(const CharacterSceneSettings& settings,
                               std::shared_ptr<const WeldedCharacter> skin, WornGarments worn)
    : ComparisonScene(worn.outfit.garment, settings.rate),
      m_skin(std::move(skin)),
      m_start(ClothState::at_rest(garment())),
      m_notes(std::move(worn.notes)),
      m_lead_in_frames(static_cast<int>(std::lround(settings.settle * settings.rate))) {
    check_range("--clearance", settings.clearance, 1e-3, 0.05);
    check_range("--settle", settings.settle, 0.0, 60.0);
    for (const Garment& one : worn.garments) distance_to_skin(one, *m_skin);
    const Outfit& outfit = worn.outfit;
    for (int part = 0; part < outfit.part_count(); ++part)
        m_parts.push_back(outfit.faces_of_part(part));
    if (outfit.has_layers()) m_self_contact.thickness = Outfit::thickness;
    GarmentFitSettings fit;
    fit.clearance = settings.clearance;
    fit.garment_name = settings.garment;
    m_start.x = wear_outfit(outfit, rest_skin(), m_skin->vertices(0.0), fit);
    if (garment().has_goals()) {
        // Fitted to the pose that it was modelled on, no goal is inside the skin there.
        const Points goals = wear_outfit(outfit, rest_skin(), rest_skin().vertices, fit);
        m_skinning = std::make_unique<const GarmentSkinning>(skin_garment(goals, *m_skin));
    }
    m_band = std::make_unique<const SkinBinding>(TriMesh{m_skin->vertices(0.0), *m_skin->faces()},
                                                 m_start.x(garment().pins(), Eigen::all));
    m_slip = std::make_unique<const SlipCheck>(
        garment(), m_start.x, TriMesh{m_skin->vertices(0.0), *m_skin->faces()}, m_skin->height());
    for (const std::string& note : character_notes(settings.character, *m_skin))
        m_notes.push_back(note);
    int available = m_skin->frame_count(frame_time()) - 1;
    if (available < 1) {
        available = settings.steps == 0 ? 3 * settings.rate - 1 : settings.steps;
        m_notes.push_back(settings.character +
                          " does not move (it has no animation, or one of a single pose): it "
                          "stands for " +
                          std::to_string(available + 1) + " frames");
    }
    set_length(settings.steps == 0 ? available : std::min(settings.steps, available), 0);
}

Points CharacterScene::skin(double time) const {
    return m_skin->vertices(std::max(0.0, time));
}

std::string CharacterScene::loss(const Boundary& boundary, const Points& x) const {
    return slip_message(m_slip->slips(boundary.obstacles[0].x1, x));
}

Boundary CharacterScene::boundary(double t0, double t1) const {
    Boundary boundary;
    boundary.obstacles.push_back(m_skin->obstacle(std::max(0.0, t0), std::max(0.0, t1)));
    boundary.pin_targets = m_band->positions(boundary.obstacles[0].x1);
    if (garment().has_goals())
        boundary.goals = skinned_goals(*m_skinning, *m_skin, std::max(0.0, t0), std::max(0.0, t1));
    return boundary;
}

}  // namespace cloth
