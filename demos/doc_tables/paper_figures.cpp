#include "demos/doc_tables/paper_figures.h"

#include <map>

namespace cloth {
namespace {

template <typename Value>
std::optional<Value> value_in(const std::map<std::string, Value>& all, const std::string& name) {
    const auto at = all.find(name);
    return at == all.end() ? std::nullopt : std::optional<Value>(at->second);
}

}  // namespace

std::optional<PaperInference> paper_inference(const std::string& network,
                                              const std::string& garment) {
    static const std::map<std::string, PaperInference> table_2 = {
        {"tshirt baseline", {21.89, 716, 0.448}},  {"tshirt sampling", {28.63, 491, 0.458}},
        {"tshirt reduction", {32.22, 557, 0.449}}, {"tshirt fast", {39.18, 373, 0.461}},
        {"pants baseline", {24.07, 692, 0.396}},   {"pants sampling", {31.01, 480, 0.405}},
        {"pants reduction", {34.74, 552, 0.398}},  {"pants fast", {41.32, 362, 0.409}},
        {"dress baseline", {10.69, 1098, 0.603}},  {"dress sampling", {13.85, 714, 0.621}},
        {"dress reduction", {15.78, 793, 0.605}},  {"dress fast", {20.06, 532, 0.625}}};
    static const std::map<std::string, PaperInference> table_3 = {
        {"hood", {18.55, 1121, 1.19}}, {"hood_fast", {32.37, 641, 1.25}}};
    if (const auto hood = value_in(table_3, network)) return hood;
    return value_in(table_2, garment + " " + network);
}

std::optional<PaperTraining> paper_training(const std::string& network) {
    static const std::map<std::string, PaperTraining> tables = {{"baseline", {52, 1.71, 22.8}},
                                                                {"sampling", {43, 1.33, 19.2}},
                                                                {"reduction", {40, 1.29, 15.1}},
                                                                {"fast", {30, 0.98, 9.8}},
                                                                {"hood", {45}},
                                                                {"hood_fast", {28}}};
    return value_in(tables, network);
}

}  // namespace cloth
