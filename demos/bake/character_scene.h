#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "data/body/garment_skinning.h"
#include "data/body/skin_binding.h"
#include "data/body/welded_character.h"
#include "data/files/painted_mesh.h"
#include "demos/bake/slip_check.h"
#include "demos/compare/comparison_scene.h"

namespace cloth {

/// A character file, a garment modelled on it, and how they come together.
struct CharacterSceneSettings {
    std::string character;  ///< its file
    CharacterSettings skin;
    /// Its mesh file; NAME.worn.obj beside NAME.obj is how it is worn. Several are joined by +, the
    /// outermost first, and have self-contact.
    std::string garment;
    double garment_scale = 1.0;  ///< metres per unit of the file, 1e-6 to 1e6
    double weld = 1e-4;          ///< vertices as near as this become one (m), 0 to 0.01
    double clearance = 4.5e-3;   ///< from skin to cloth at the start (m), 1e-3 to 0.05
    /// How colours of the garment's vertices are read as goals; empty: they are not. Attributes
    /// of its file always are, see load_painted_mesh().
    std::optional<GoalColours> goal_colours;
    std::vector<double> pin;  ///< lowest and highest vertex that rides on the skin (m), or empty
    std::string fabric = "soft";  ///< see fabric_named()
    double settle = 0.5;          ///< the first pose is held for so long (s), 0 to 60
    int rate = 30;                ///< frames per second
    int steps = 0;                ///< of the animation; 0: all, or 3 s of a character that stands
};

/// A garment on an animated character, and near its skin as far as goals are painted in its file.
/// The clock starts with the animation; in the lead-in the
/// first pose is held and the garment comes to hang.
class CharacterScene : public ComparisonScene {
 public:
    /// @throws LoadError, ArgumentError if character or garment cannot be had or do not fit
    explicit CharacterScene(const CharacterSceneSettings& settings);

    const TriMesh& rest_skin() const { return m_skin->rest(); }
    /// Faces of each garment, numbered as all vertices are.
    const std::vector<Faces>& parts() const { return m_parts; }
    /// What is to be told of the files, a sentence each.
    const std::vector<std::string>& notes() const { return m_notes; }
    /// Skin of the character at a time of the clock (|V| x 3, m).
    Points skin(double time) const;

    Boundary boundary(double t0, double t1) const override;
    /// Fitted to the first pose.
    ClothState start() const override { return m_start; }
    int lead_in_frames() const override { return m_lead_in_frames; }
    SelfContactSettings self_contact() const override { return m_self_contact; }
    /// A piece of the garment slid off, see SlipCheck.
    std::string loss(const Boundary& boundary, const Points& x) const override;

 private:
    struct WornGarments;
    CharacterScene(const CharacterSceneSettings& settings,
                   std::shared_ptr<const WeldedCharacter> skin, WornGarments worn);
    static WornGarments read_garments(const CharacterSceneSettings& settings);

    std::shared_ptr<const WeldedCharacter> m_skin;
    std::vector<Faces> m_parts;  ///< of each garment
    ClothState m_start;
    SelfContactSettings m_self_contact;
    std::unique_ptr<const SkinBinding> m_band;
    std::unique_ptr<const GarmentSkinning> m_skinning;  ///< if goals are painted
    std::unique_ptr<const SlipCheck> m_slip;
    std::vector<std::string> m_notes;
    int m_lead_in_frames;
};

}  // namespace cloth
