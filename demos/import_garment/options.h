#pragma once

#include <optional>
#include <string>
#include <vector>

#include "data/authoring/garment_import.h"
#include "data/body/skinned_character.h"
#include "data/files/painted_mesh.h"

namespace cloth {

struct ImportOptions {
    std::string file;    ///< of the garment
    std::string mesh;    ///< in the file; empty: all
    double scale = 1.0;  ///< metres per unit of the file
    bool z_up = false;
    bool up_is_given = false;  ///< the axis is not to be doubted
    Vec3 move = Vec3::Zero();  ///< (m)

    std::string character;  ///< its file; empty: the project's body
    CharacterSettings skin;
    double character_weld = 1e-4;  ///< as bake has it (m)
    std::string body = "default";  ///< that the file was modelled on, see body_named()

    GarmentImportSettings import;
    std::optional<GoalColours> goal_colours;  ///< see load_painted_mesh()
    std::string name;                         ///< of the garment; empty: the file's
    std::string out = "out/import";
    bool picture = true;
    std::string
        programs;  ///< what is put before the programs that are proposed: their folder and /
};

/// @throws UsageError naming the option; HelpText if it is asked for; ArgumentError for a unit or a
///         setting out of range
ImportOptions parse_import_options(const std::vector<std::string>& arguments);

}  // namespace cloth
