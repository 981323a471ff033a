#include "demos/doc_tables/data_sets.h"

namespace cloth {

using Json = nlohmann::ordered_json;

namespace {

const std::string figures = "data/assets/figures/";

/// Medians and counters of a report of Google Benchmark; the machine's name on its network and the
/// repetitions are left out.
Json tidy_benchmark(const Json& report) {
    const Json& context = report.at("context");
    Json tidy;
    tidy["provenance"] = {{"commit", context.at("commit")},
                          {"machine", context.at("machine")},
                          {"threads", context.at("threads")},
                          {"date", context.at("date").get<std::string>().substr(0, 10)}};
    tidy["benchmarks"] = Json::array();
    for (const Json& row : report.at("benchmarks")) {
        if (row.value("aggregate_name", "") != "median") continue;
        Json kept = row;
        kept["name"] = row.at("run_name");
        for (const char* member :
             {"family_index", "per_family_instance_index", "run_name", "run_type", "repetitions",
              "repetition_index", "threads", "aggregate_name", "aggregate_unit", "iterations"})
            kept.erase(member);
        tidy["benchmarks"].push_back(kept);
    }
    return tidy;
}

std::string benchmark_command(const std::string& program) {
    return "build/release/tests/bench/" + program +
           " --benchmark_min_time=0.1 --benchmark_repetitions=3"
           " --benchmark_enable_random_interleaving=true"
           " --benchmark_out_format=json --benchmark_out=OUT/report.json";
}

/// The report of a program as it writes it.
DataSet report_of(const std::string& name, const std::string& command, const std::string& report) {
    return {name, figures + name + ".json", command, report, {}, {}};
}

/// Steps of 1/60 s, one second of them.
DataSet real_time(const std::string& garment) {
    return report_of(
        "real_time_" + garment,
        "build/release/demos/speed_error --garment " + garment +
            " --rate 60 --frames 60 --relative-to xpbd-20 --solvers"
            " bullet-fine,xpbd-20,default,default@16,default@8,quasi-newton-3,quasi-newton-10,"
            "quasi-newton,quasi-newton@16,quasi-newton@8,quasi-newton-50x4,quasi-newton-50x16 "
            "--out OUT",
        "speed_error.json");
}

/// What networks bring over a proxy, on one garment.
DataSet learned(const std::string& garment) {
    return report_of(
        "learned_" + garment,
        "build/release/demos/speed_error --garment " + garment +
            " --limbs --frames 30 --relative-to quasi-newton-10 --solvers xpbd-40,"
            "quasi-newton-10,default,small+3,quasi-newton-2s60~1000,small+3~1000,small+3~700,"
            "small60+1s60~1000,small60+2s60~1500,hood_fast_own+0,hood_fast_coarse+0~1000,"
            "hood_fast_coarse60+0s60~1000 --out OUT",
        "speed_error.json");
}

/// Networks by themselves, on the clips that they were not trained on.
DataSet alone(const std::string& garment) {
    return report_of(
        "alone_" + garment,
        "build/release/demos/hard_cases --motions ../shared/data/motions/validation --garment " +
            garment +
            " --steppers hood_fast_own+0,hood_fast_coarse+0~1000,hood_fast_coarse+0~1500,"
            "hood_fast_coarse60+0s60~1000,hood_fast_coarse60+0s60~1500,small+3~1000,small+3~1500,"
            "small60+1s60~1000,small60+2s60~1500,xpbd-40 --no-pictures --out OUT",
        "hard_cases.json");
}

DataSet motions(const std::string& name, const std::string& options) {
    return report_of(name,
                     "build/release/demos/hard_cases"
                     " --motions ../shared/data/motions/validation,../shared/data/motions/train"
                     " --steppers reference,quasi-newton,small,quasi-newton-3s120" +
                         options + " --no-pictures --out OUT",
                     "hard_cases.json");
}

}  // namespace

std::vector<DataSet> data_sets() {
    return {
        learned("tshirt"),
        learned("pants"),
        learned("dress"),
        alone("tshirt"),
        alone("pants"),
        alone("dress"),
        {"whole_motion",
         figures + "whole_motion.json",
         "build/release/demos/compare --garment tshirt --motion 01_01 --frames 0"
         " --reference-frames 0 --no-video --out OUT --solvers "
         "bullet,bullet-fine,reference,default,quasi-newton-1,quasi-newton-3,quasi-newton-10,"
         "quasi-newton-10-bdf2,quasi-newton,xpbd-40,small,small+3,medium+3,fast,small+0,medium+0,"
         "sampling_own+0,hood_fast_own+0",
         "report.json",
         {},
         {}},
        {"proxy",
         figures + "proxy.json",
         "OMP_NUM_THREADS=1 build/release/demos/compare --garment tshirt --motion 01_01 --frames 90"
         " --reference-frames 90 --no-video --out OUT --solvers "
         "default,default~1000,default~tshirt_1000,default~1000+1,default~tshirt_1000+1,"
         "default~1000+small_detail,default~1000+small_detail+1,xpbd-40,xpbd-40~1000,"
         "xpbd-40~1000+1",
         "report.json",
         {},
         {}},
        {"detail",
         figures + "detail.json",
         "build/release/demos/speed_error --scene all --limbs --frames 30 --relative-to xpbd-40"
         " --solvers xpbd-40,default,default~1000,default~1000+1,default~1000+2,"
         "default~1000+small_detail,default~1000+small_detail+1,default~1000+small,"
         "default~1000+small+1,xpbd-40~1000+1,xpbd-40~1000+small_detail+1 --out OUT",
         "speed_error.json",
         {},
         {}},
        {"which_solver",
         figures + "which_solver.json",
         "build/release/demos/speed_error --scene all --limbs --frames 30 --relative-to xpbd-40"
         " --solvers xpbd-40,quasi-newton-10,quasi-newton,quasi-newton-bdf2,quasi-newton-1s120,"
         "quasi-newton-2s60,quasi-newton-2s120,quasi-newton-3s120,quasi-newton-5s120,"
         "quasi-newton-2s240,quasi-newton-3s120-bdf2,default~1000+1,small+3~1000,small60+1s60~1000,"
         "small60+2s60~1500,small60+2s60,small,small+2s120,small+3"
         " --out OUT",
         "speed_error.json",
         {},
         {}},
        {"speed_error",
         figures + "speed_error.json",
         "build/release/demos/speed_error --scene all --frames 30 --out OUT",
         "speed_error.json",
         {},
         {{"tshirt_soft_fine_rmse.svg", figures + "speed_error_tshirt_soft_fine_rmse.svg"},
          {"tshirt_soft_gap.svg", figures + "speed_error_tshirt_soft_gap.svg"}}},
        {"stiff",
         figures + "stiff.json",
         "build/release/demos/speed_error --scene all --fabric real --frames 30 --relative-to "
         "xpbd-40 --solvers bullet-fine,xpbd-40,xpbd-100,quasi-newton-10,quasi-newton,"
         "quasi-newton-bdf2,quasi-newton-3s120,quasi-newton-1s120-cg10,quasi-newton-2s120-cg10"
         " --out OUT",
         "speed_error.json",
         {},
         {}},
        real_time("tshirt"),
        real_time("tshirt_1000"),
        {"max_ms",
         figures + "max_ms.json",
         "build/release/demos/speed_error --garment tshirt --frames 60 --relative-to "
         "quasi-newton-10"
         " --solvers default,default@40,default@20,quasi-newton-10,quasi-newton,quasi-newton@40,"
         "quasi-newton@20,"
         "small+3,small,small@40,small@20 --out OUT",
         "speed_error.json",
         {},
         {}},
        {"scaling",
         figures + "scaling.json",
         "build/release/demos/scaling --out OUT",
         "scaling.json",
         {},
         {{"scaling.svg", figures + "scaling.svg"}}},
        {"many_characters",
         figures + "many_characters.json",
         "build/release/demos/many_characters --out OUT",
         "many_characters.json",
         {},
         {}},
        {"generalisation",
         figures + "generalisation.json",
         "build/release/demos/generalisation --out OUT",
         "generalisation.json",
         {},
         {}},
        {"lookbook",
         figures + "lookbook.json",
         "build/release/demos/lookbook --no-video --out OUT",
         "lookbook.json",
         {},
         {{"lookbook.png", figures + "lookbook.png"}}},
        {"hard_cases",
         figures + "hard_cases.json",
         "build/release/demos/hard_cases"
         " --steppers default,quasi-newton,quasi-newton-bdf2,small,small+3,fast,fast+0,"
         "xpbd-40 "
         "--no-pictures --out OUT",
         "hard_cases.json",
         {},
         {}},
        {"starts",
         figures + "starts.json",
         "build/release/demos/hard_cases --cases clipping-armature,fast-cape --starts 32"
         " --steppers default,quasi-newton,small,xpbd-40 --no-pictures --out OUT",
         "hard_cases.json",
         {},
         {}},
        motions("motions", ""),
        motions("motions_no_limbs", " --no-limbs"),
        {"clip_times",
         figures + "clip_times.json",
         "build/release/demos/hard_cases"
         " --motions ../shared/data/motions/validation,../shared/data/motions/train"
         " --garment tshirt --steppers default,default~1000+1,xpbd-40 --no-pictures --out OUT",
         "hard_cases.json",
         {},
         {}},
        {"bullet_scenes",
         figures + "bullet_scenes.json",
         "OMP_NUM_THREADS=1 build/release/demos/bullet_scenes --scene small"
         " --solvers bullet,default,small --no-videos --out OUT",
         "bullet_scenes.json",
         {},
         {}},
        {"bullet_demos",
         figures + "bullet_demos.json",
         "OMP_NUM_THREADS=1 build/release/demos/bullet_scenes --scene"
         " Cloth,ClothAttach,CapsuleCollision,Collide3,Cutting1,SimpleCloth,Aero,Aero2"
         " --solvers bullet,default,small --reference none --no-videos --out OUT",
         "bullet_scenes.json",
         {},
         {}},
        {"engine",
         figures + "engine_bench.json",
         benchmark_command("engine_bench"),
         "report.json",
         tidy_benchmark,
         {}},
        {"step",
         figures + "step.json",
         benchmark_command("step_bench"),
         "report.json",
         tidy_benchmark,
         {}},
        {"bfloat16_rollout",
         figures + "bfloat16_rollout.json",
         "build/release/demos/compare --garment tshirt --motion 01_01 --frames 15"
         " --reference-frames 15 --no-video --out OUT"
         " --solvers fast+0,bf16-fast+0,fast,bf16-fast",
         "report.json",
         {},
         {}},
        {"neighbours",
         figures + "neighbours.json",
         "OMP_NUM_THREADS=1 nice -n 19 build/release/demos/train_series --series neighbours"
         " --seeds 1 --out OUT",
         "train_series.json",
         {},
         {}},
        {"paper_tables",
         figures + "paper_tables.json",
         "build/release/demos/paper_tables --references out/paper_references --out OUT",
         "paper_tables.json",
         {},
         {{"figure_6.csv", figures + "paper_figure_6.csv"},
          {"figure_6.svg", figures + "paper_figure_6.svg"},
          {"figure_7.svg", figures + "paper_figure_7.svg"}}},
        {"self_contact",
         figures + "self_contact.json",
         "OMP_NUM_THREADS=1 " + benchmark_command("self_contact_bench"),
         "report.json",
         tidy_benchmark,
         {}},
    };
}

}  // namespace cloth
