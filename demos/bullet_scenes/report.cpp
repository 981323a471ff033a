#include "demos/bullet_scenes/report.h"

#include <omp.h>

#include <cmath>
#include <cstdio>

#include "demos/compare/json_numbers.h"
#include "demos/provenance/provenance.h"
#include "render/replaced_file.h"

namespace cloth {

namespace {

std::string number(double value, const char* format) {
    if (!std::isfinite(value)) return "-";
    char text[32];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

}  // namespace

nlohmann::ordered_json scene_row_json(const SceneRow& row) {
    return {{"scene", row.scene},
            {"solver", row.solver},
            {"rate_hz", row.rate_hz},
            {"finite", row.finite},
            {"cloth_bodies", row.cloth_bodies},
            {"rest_error_mm", json_number(row.rest_error_mm)},
            {"rest_energy_mm", json_number(row.rest_energy_mm)},
            {"speed_end_mm_s", json_number(row.speed_end_mm_s)},
            {"momentum_error", json_number(row.momentum_error)},
            {"penetration_max_mm", json_number(row.penetration_max_mm)},
            {"energy_rise_j", json_number(row.energy_rise_j)},
            {"energy_scale_j", json_number(row.energy_scale_j)},
            {"stretch_p99", json_number(row.stretch_p99)},
            {"stretch_max", json_number(row.stretch_max)},
            {"node_speed_max", json_number(row.node_speed_max)},
            {"body_speed_max", json_number(row.body_speed_max)},
            {"ms_mean", json_number(row.ms_mean)},
            {"ms_worst", json_number(row.ms_worst)},
            {"times_bullet", json_number(row.times_bullet)},
            {"ms_median", json_number(row.ms_median)},
            {"ms_median_last_second", json_number(row.ms_median_last_second)}};
}

std::string scene_row_heading() {
    return "scene            solver             steps  finite  rest (mm)  energy (mm)  mm/s at end "
           " "
           "momentum  inside (mm)  rise (J)  rise/scale  stretch p99  max    node m/s  body m/s  "
           "ms/step  worst    x Bullet";
}

std::string scene_row_text(const SceneRow& row) {
    char text[320];
    std::snprintf(
        text, sizeof text,
        "%-16s %-18s %-6s %-6s  %9s  %11s  %11s  %8s  %11s  %8s  %10s  %11s  %-5s  %8s  %8s  "
        "%7s  %-7s  %s",
        row.scene.c_str(), row.solver.c_str(),
        row.rate_hz > 0 ? ("1/" + std::to_string(row.rate_hz)).c_str() : "random",
        row.finite ? "yes" : "NO", number(row.rest_error_mm, "%.1f").c_str(),
        number(row.rest_energy_mm, "%.2f").c_str(), number(row.speed_end_mm_s, "%.2f").c_str(),
        number(row.momentum_error, "%.4f").c_str(), number(row.penetration_max_mm, "%.1f").c_str(),
        number(row.energy_rise_j, "%.3g").c_str(),
        number(row.energy_rise_j / row.energy_scale_j, "%.5f").c_str(),
        number(row.stretch_p99, "%.3f").c_str(), number(row.stretch_max, "%.3f").c_str(),
        number(row.node_speed_max, "%.1f").c_str(), number(row.body_speed_max, "%.1f").c_str(),
        number(row.ms_mean, "%.2f").c_str(), number(row.ms_worst, "%.1f").c_str(),
        number(row.times_bullet, "%.2f").c_str());
    return text;
}

void write_scene_report(const std::string& path, const std::vector<SceneRow>& rows) {
    nlohmann::ordered_json document;
    document["provenance"] = provenance_json(omp_get_max_threads());
    document["rows"] = nlohmann::ordered_json::array();
    for (const SceneRow& row : rows) document["rows"].push_back(scene_row_json(row));
    write_text_file(path, document.dump(2) + "\n");
}

}  // namespace cloth
