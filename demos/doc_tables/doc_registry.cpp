#include "demos/doc_tables/data_sets.h"
#include "demos/doc_tables/engine_tables.h"
#include "demos/doc_tables/motion_tables.h"
#include "demos/doc_tables/paper_tables.h"
#include "demos/doc_tables/scaling_tables.h"
#include "demos/doc_tables/solver_tables.h"
#include "demos/doc_tables/wardrobe_tables.h"

namespace cloth {

namespace {

DocTable paper_table_of(const std::string& garment) {
    return {"paper_" + garment, {"paper_tables"}, [garment](const std::vector<DataFile>& files) {
                return paper_garment_table(files, garment);
            }};
}

/// Which command makes which file.
MarkdownTable commands_table() {
    MarkdownTable table;
    table.heading = {"name", "file", "command"};
    for (const DataSet& set : data_sets())
        table.rows.push_back({set.name, "`" + set.file + "`", "`" + set.command + "`"});
    return table;
}

}  // namespace

const Registry& doc_registry() {
    static const Registry registry = {
        data_sets(),
        {{"which_solver", {"which_solver"}, which_solver_table},
         {"small_steps", {"which_solver"}, small_steps_table},
         {"whole_motion", {"whole_motion"}, whole_motion_table},
         {"proxy", {"proxy"}, proxy_table},
         {"detail", {"detail"}, detail_table},
         {"learned", {"learned_tshirt", "learned_pants", "learned_dress"}, learned_table},
         {"alone", {"alone_tshirt", "alone_pants", "alone_dress"}, alone_table},
         {"speed_error", {"speed_error"}, speed_error_table},
         {"stiff", {"stiff"}, stiff_table},
         {"real_time", {"real_time_tshirt", "real_time_tshirt_1000"}, real_time_table},
         {"max_ms", {"max_ms"}, real_time_table},
         {"scaling", {"scaling"}, scaling_table},
         {"many_characters", {"many_characters"}, many_characters_table},
         {"generalisation", {"generalisation"}, generalisation_table},
         {"lookbook", {"lookbook"}, lookbook_table},
         {"hard_cases", {"hard_cases"}, hard_cases_table},
         {"starts", {"starts"}, starts_table},
         {"motions", {"motions", "motions_no_limbs"}, motions_table},
         {"clip_times", {"clip_times"}, clip_times_table},
         {"bullet_scenes", {"bullet_scenes"}, bullet_scenes_table},
         {"bullet_demos", {"bullet_demos"}, bullet_demos_table},
         {"engine", {"engine"}, engine_table},
         {"bfloat16", {"engine"}, bfloat16_table},
         {"edge_block", {"engine"}, edge_block_table},
         {"bfloat16_rollout", {"bfloat16_rollout"}, bfloat16_rollout_table},
         {"step", {"step"}, step_table},
         {"self_contact", {"self_contact"}, self_contact_table},
         {"paper_claims", {"paper_tables"}, paper_claims_table},
         {"paper_training", {"paper_tables"}, paper_training_table},
         paper_table_of("tshirt"),
         paper_table_of("pants"),
         paper_table_of("dress"),
         paper_table_of("tshirt_1000"),
         {"paper_hood", {"paper_tables"}, paper_hood_table},
         {"paper_terms", {"paper_tables"}, paper_terms_table},
         {"paper_neighbours", {"paper_tables"}, paper_neighbours_table},
         {"commands", {}, [](const std::vector<DataFile>&) { return commands_table(); }}}};
    return registry;
}

}  // namespace cloth
