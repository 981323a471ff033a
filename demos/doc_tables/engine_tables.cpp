#include "demos/doc_tables/engine_tables.h"

namespace cloth {

namespace {

DataRow benchmark(const DataFile& file, const std::string& name) {
    return file.row("benchmarks", {{"name", name}});
}

DataRow engine(const DataFile& file, const std::string& network) {
    return benchmark(file, "engine/" + network + "/threads:2/real_time");
}
DataRow engine_bf16(const DataFile& file, const std::string& network) {
    return benchmark(file, "engine-bf16/" + network + "/threads:2/real_time");
}

double ms(const DataRow& row) {
    return row.number("/real_time");
}

std::string percent(double part, int digits = 0) {
    return decimals(100.0 * part, digits) + " %";
}

}  // namespace

MarkdownTable engine_table(const std::vector<DataFile>& files) {
    const DataFile& file = files.at(0);
    MarkdownTable table;
    table.heading = {"network",
                     "width",
                     "float32 (ms)",
                     "of the multiply-add peak",
                     "bfloat16 (ms)",
                     "LibTorch (ms)",
                     "LibTorch / float32",
                     "LibTorch / bfloat16",
                     "weights, float32 / bfloat16 (MB)",
                     "topology (MB)",
                     "workspace (MB)",
                     "LibTorch's peak (MB)"};
    for (const char* width : {"32", "64", "128"})
        for (const char* variant : {"baseline", "sampling", "reduction", "fast"}) {
            const std::string network = std::string(variant) + "/" + width;
            const DataRow own = engine(file, network), half = engine_bf16(file, network),
                          torch = benchmark(file, "libtorch/" + network + "/real_time");
            table.rows.push_back(
                {variant, width, decimals(ms(own), 0), percent(own.number("/of_peak")),
                 decimals(ms(half), 0), decimals(ms(torch), 0), decimals(ms(torch) / ms(own), 1),
                 decimals(ms(torch) / ms(half), 1),
                 decimals(own.number("/weights_MB"), 1) + " / " +
                     decimals(half.number("/weights_MB"), 1),
                 decimals(own.number("/topology_MB"), 1), decimals(own.number("/workspace_MB"), 1),
                 decimals(torch.number("/peak_MB"), 0)});
        }
    return table;
}

MarkdownTable bfloat16_table(const std::vector<DataFile>& files) {
    MarkdownTable table;
    table.heading = {"shipped weights", "float32 (ms)", "bfloat16 (ms)", "error of bfloat16"};
    for (const char* name : {"baseline", "sampling", "reduction", "fast", "small"}) {
        const std::string network = std::string("shipped/") + name;
        const DataRow half = engine_bf16(files.at(0), network);
        table.rows.push_back({name, significant(ms(engine(files.at(0), network)), 2),
                              significant(ms(half), 2), percent(half.number("/error"), 1)});
    }
    return table;
}

MarkdownTable edge_block_table(const std::vector<DataFile>& files) {
    MarkdownTable table;
    table.heading = {"width", "float32 (GFLOP/s)", "of the peak", "bfloat16 (GFLOP/s)"};
    for (const char* width : {"16", "32", "64", "128"}) {
        const DataRow own =
                          benchmark(files.at(0), std::string("edge_block<AlignedBuffer>/") + width),
                      half =
                          benchmark(files.at(0), std::string("edge_block<AlignedHalves>/") + width);
        table.rows.push_back({width, decimals(own.number("/GFLOP~1s"), 0),
                              percent(own.number("/of_peak")),
                              decimals(half.number("/GFLOP~1s"), 0)});
    }
    return table;
}

MarkdownTable step_table(const std::vector<DataFile>& files) {
    const std::pair<const char*, const char*> stages[] = {
        {"fit_trees", "body: hierarchy fitted to a pose"},
        {"nearest_points", "nearest points of all vertices"},
        {"ridges", "contacts at ridges"},
        {"limbs", "limbs that cloth ignores"},
        {"contact_projection", "contact projection, with nearest points"},
        {"begin_potential", "potential of the step"},
        {"strain", "strain and its gradient"},
        {"bending", "bending and its gradient"},
        {"energy_gradient", "energy and its gradient"},
        {"matrix_solve", "solve with the constant matrix"},
        {"contact_solve", "solve with contact in it"},
        {"minimise<3>", "three iterations"},
        {"minimise<10>", "ten iterations"},
        {"features", "network `small`: features"},
        {"network", "network `small`"},
        {"whole_step<false, 3>", "whole step, `quasi-newton-3`, with limbs"},
        {"whole_step<false, 10>", "whole step, `quasi-newton-10`, with limbs"},
        {"whole_step<true, 3>", "whole step, `small+3`, with limbs"}};
    MarkdownTable table;
    table.heading = {"stage", "one thread (us)", "two threads (us)", "ns per vertex",
                     "floor of its arithmetic (us)"};
    for (const auto& [name, what] : stages) {
        const bool is_whole = std::string(name).find("whole") == 0;
        const auto with = [&, name = name](const char* threads) {
            return benchmark(files.at(0), std::string(name) + "/" + threads +
                                              (is_whole ? "/min_time:1.500" : "") + "/real_time");
        };
        const DataRow one = with("1");
        table.rows.push_back({what, significant(one.number("/real_time"), 2),
                              significant(with("2").number("/real_time"), 2),
                              significant(one.number("/per_vertex"), 2),
                              one.has("/floor_us") ? significant(one.number("/floor_us"), 2) : ""});
    }
    return table;
}

MarkdownTable self_contact_table(const std::vector<DataFile>& files) {
    MarkdownTable table;
    table.heading = {"sheet", "vertices", "without (ms)", "with self-contact (ms)"};
    const std::pair<const char*, const char*> scenes[] = {{"0", "meets itself nowhere"},
                                                          {"1", "folded in half"}};
    for (const auto& [meets, what] : scenes)
        for (const char* vertices : {"1000", "4000"}) {
            const auto time = [&, meets = meets](const char* with) {
                return benchmark(files.at(0), std::string("step/meets:") + meets +
                                                  "/vertices:" + vertices + "/self_contact:" + with)
                    .number("/cpu_time");
            };
            table.rows.push_back(
                {what, vertices, significant(time("0"), 2), significant(time("1"), 2)});
        }
    return table;
}

}  // namespace cloth
