#include <algorithm>
#include <cmath>
#include <functional>

#include "demos/doc_tables/paper_data.h"
#include "demos/doc_tables/paper_figures.h"
#include "demos/doc_tables/paper_tables.h"

namespace cloth {
namespace {

constexpr double tolerance = 0.03;  // of a ratio: what two runs of one program may differ by

enum class Verdict { yes, less, no, unknown };

/// A figure that the paper has too. 1: it makes no difference.
struct Compared {
    double paper, ours;
    bool more_is_better;

    Verdict verdict() const {
        if (std::isnan(ours)) return Verdict::unknown;
        const double sign = more_is_better ? 1.0 : -1.0;
        if (sign * (ours - paper * (1.0 - sign * tolerance)) >= 0.0) return Verdict::yes;
        return sign * (ours - 1.0) > tolerance ? Verdict::less : Verdict::no;
    }
};

/// yes or no if all agree; what is not known does not count.
std::string verdict_of(const std::vector<Compared>& all) {
    int known = 0, yes = 0, no = 0;
    for (const Compared& one : all) {
        const Verdict verdict = one.verdict();
        known += verdict != Verdict::unknown ? 1 : 0;
        yes += verdict == Verdict::yes ? 1 : 0;
        no += verdict == Verdict::no ? 1 : 0;
    }
    if (known == 0) return "not measured";
    if (yes == known) return "yes";
    if (no == known) return "no";
    return yes + no == 0 ? "less than in the paper" : "in part";
}

std::vector<std::string> claim_row(const std::string& claim, const std::vector<Compared>& all) {
    std::string paper, ours;
    for (const Compared& one : all) {
        const std::string separator = paper.empty() ? "" : " / ";
        paper += separator + decimals(one.paper, 2);
        ours += separator + decimals(one.ours, 2);
    }
    return {claim, paper, ours, verdict_of(all)};
}

/// A network's figure over that of another, on the three garments.
std::vector<Compared> inference_ratios(const PaperData& data, const std::string& network,
                                       const std::string& other, double PaperInference::*member,
                                       const std::string& pointer, bool more_is_better) {
    std::vector<Compared> ratios;
    for (const char* garment : paper_garments)
        ratios.push_back({(*paper_inference(network, garment)).*member /
                              (*paper_inference(other, garment)).*member,
                          data.number(garment, network + "+0", pointer) /
                              data.number(garment, other + "+0", pointer),
                          more_is_better});
    return ratios;
}

Compared training_ratio(const std::string& network, const std::string& other,
                        double PaperTraining::*member,
                        const std::function<double(const std::string&)>& ours) {
    return {(*paper_training(network)).*member / (*paper_training(other)).*member,
            ours(network) / ours(other), false};
}

/// The same of an evaluation of the network, without the rest of a step.
std::vector<Compared> network_speeds(const PaperData& data, const std::string& network,
                                     const std::string& other) {
    std::vector<Compared> ratios =
        inference_ratios(data, network, other, &PaperInference::fps, "/network_ms", true);
    for (Compared& one : ratios) one.ours = 1.0 / one.ours;
    return ratios;
}

void add_inference(const PaperData& data, MarkdownTable& table) {
    using Paper = PaperInference;
    for (const char* network : {"sampling", "reduction", "fast"})
        table.rows.push_back(claim_row(
            std::string(network) + " over baseline: evaluations of the network per second",
            network_speeds(data, network, "baseline")));
    for (const char* network : {"sampling", "reduction", "fast"})
        table.rows.push_back(
            claim_row(std::string(network) + " over baseline: frames per second",
                      inference_ratios(data, network, "baseline", &Paper::fps, "/fps", true)));
    for (const char* network : {"sampling", "reduction", "fast"})
        table.rows.push_back(claim_row(
            std::string(network) + " over baseline: memory",
            inference_ratios(data, network, "baseline", &Paper::memory_mb, "/memory_mb", false)));
    table.rows.push_back(claim_row(
        "fast over baseline: memory of the network in the engine",
        inference_ratios(data, "fast", "baseline", &Paper::memory_mb, "/network_mb", false)));
    for (const char* network : {"sampling", "reduction", "fast"})
        table.rows.push_back(claim_row(
            std::string(network) + " over baseline: loss",
            inference_ratios(data, network, "baseline", &Paper::loss, "/loss/total", false)));
    table.rows.push_back(claim_row("HOOD + ours over HOOD: evaluations of the network per second",
                                   network_speeds(data, "hood_fast", "hood")));
    table.rows.push_back(
        claim_row("HOOD + ours over HOOD: frames per second",
                  inference_ratios(data, "hood_fast", "hood", &Paper::fps, "/fps", true)));
    table.rows.push_back(claim_row(
        "HOOD + ours over HOOD: memory",
        inference_ratios(data, "hood_fast", "hood", &Paper::memory_mb, "/memory_mb", false)));
    table.rows.push_back(claim_row(
        "HOOD + ours over HOOD: memory of the network in the engine",
        inference_ratios(data, "hood_fast", "hood", &Paper::memory_mb, "/network_mb", false)));
    table.rows.push_back(
        claim_row("HOOD + ours over HOOD: loss",
                  inference_ratios(data, "hood_fast", "hood", &Paper::loss, "/loss/total", false)));
}

void add_training(const PaperData& data, MarkdownTable& table) {
    using Paper = PaperTraining;
    const double gap = data.common_gap(), smallest = data.training("smallest", "/peak_mb");
    const auto cost = [&](const std::string& network) {
        return data.training(network, "/s_per_iteration");
    };
    const auto memory = [&](const std::string& network) {
        return data.training(network, "/peak_mb") - smallest;
    };
    const auto time = [&](const std::string& network) {
        return cost(network) * data.iterations_to(network, gap);
    };
    for (const char* network : {"sampling", "reduction", "fast"})
        table.rows.push_back(
            claim_row(std::string(network) + " over baseline: time of a training iteration",
                      {training_ratio(network, "baseline", &Paper::s_per_iteration, cost)}));
    table.rows.push_back(
        claim_row("fast over baseline: memory of training, without that of the smallest network",
                  {training_ratio("fast", "baseline", &Paper::memory_gb, memory)}));
    table.rows.push_back(claim_row("fast over baseline: training time to the same gap",
                                   {training_ratio("fast", "baseline", &Paper::hours, time)}));
    table.rows.push_back(claim_row("HOOD + ours over HOOD: training time to the same gap",
                                   {training_ratio("hood_fast", "hood", &Paper::hours, time)}));
}

std::string known_verdict(double value, bool holds) {
    return std::isnan(value) ? "not measured" : holds ? "yes" : "no";
}

void add_figure_6(const PaperData& data, MarkdownTable& table) {
    const auto ratio = [&](const std::string& term) {
        return data.number("tshirt", "fast+0", "/loss/" + term) /
               data.number("tshirt", "baseline+0", "/loss/" + term);
    };
    const double strain = ratio("strain");
    table.rows.push_back({"fast over baseline: strain is slightly higher (figure 6)",
                          "no figure; taken as 1 to 1.1", decimals(strain, 2),
                          known_verdict(strain, strain >= 1.0 - tolerance && strain <= 1.1)});
    // Gravity is left out: a ratio of it says nothing, as its zero is a matter of choice.
    double most = 1.0;
    std::string which = "all";
    for (const char* term : {"bending", "contact", "inertia", "friction"}) {
        const double other = ratio(term);
        if (std::isnan(other)) most = other;
        if (!(other > most)) continue;
        most = other;
        which = term;
    }
    table.rows.push_back(
        {"fast over baseline: other terms are hardly higher (figure 6)",
         "no figure; taken as 1.1 times at most",
         std::isnan(most) ? decimals(most, 2) : significant(most, 2) + " times at most: " + which,
         known_verdict(most, most <= 1.1)});
}

void add_figure_7(const PaperData& data, MarkdownTable& table) {
    const auto gap = [&](int count) { return data.neighbours(count, "gap_tshirt_median"); };
    const double first = gap(1) - gap(4), rest = gap(4) - gap(7);
    const auto falls = [&](double fall) { return std::isnan(fall) ? "–" : significant(fall, 2); };
    table.rows.push_back(
        {"more sampled neighbours, less loss: the gap's fall from 1 to 4 (figure 7)", "falls",
         falls(first), known_verdict(first, first > 0.0)});
    table.rows.push_back(
        {"from 4 neighbours on it falls less: the gap's fall from 4 to 7 (figure 7)",
         "less than from 1 to 4", falls(rest), known_verdict(first - rest, rest < first)});
}

void add_real_time(const PaperData& data, MarkdownTable& table) {
    std::vector<Compared> speeds;
    for (const char* garment : paper_garments)
        speeds.push_back({(*paper_inference("fast", garment)).fps,
                          data.number(garment, "fast+0", "/fps"), true});
    table.rows.push_back(claim_row("fast: frames per second, there on an RTX 3090", speeds));
}

}  // namespace

MarkdownTable paper_claims_table(const std::vector<DataFile>& files) {
    const PaperData data(files.at(0));
    MarkdownTable table;
    table.heading = {"claim (T-shirt / pants / dress)", "paper", "here", "holds"};
    add_inference(data, table);
    add_training(data, table);
    add_figure_6(data, table);
    add_figure_7(data, table);
    add_real_time(data, table);
    return table;
}

}  // namespace cloth
