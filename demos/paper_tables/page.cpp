#include "demos/paper_tables/page.h"

#include <algorithm>
#include <vector>

#include "demos/doc_tables/paper_tables.h"

namespace cloth {
namespace {

std::string section(const std::string& title, const MarkdownTable& table) {
    return "\n## " + title + "\n\n" + to_markdown(table) + "\n";
}

std::vector<std::string> garments_of(const DataFile& file) {
    std::vector<std::string> garments;
    for (const DataRow& row : file.rows("rows"))
        if (std::find(garments.begin(), garments.end(), row.text("/garment")) == garments.end())
            garments.push_back(row.text("/garment"));
    return garments;
}

std::string provenance_line(const nlohmann::ordered_json& provenance) {
    std::string line = "Commit " + provenance.at("commit").get<std::string>() + "; machine " +
                       provenance.at("machine").get<std::string>() + "; threads " +
                       provenance.at("threads").dump() + "; date " +
                       provenance.at("date").get<std::string>() + ".";
    if (provenance.contains("note")) line += " " + provenance.at("note").get<std::string>();
    return line;
}

}  // namespace

std::string paper_page(const std::string& path, const nlohmann::ordered_json& report) {
    const std::vector<DataFile> files = {DataFile(path, report)};
    std::string text =
        "# The paper's tables, measured here\n\n" + provenance_line(report.at("provenance")) + "\n";
    text += section("Claims", paper_claims_table(files));
    text += section("Table 1: training", paper_training_table(files));
    for (const std::string& garment : garments_of(files[0]))
        text += section("Table 2: " + garment, paper_garment_table(files, garment));
    text += section("Table 3: HOOD", paper_hood_table(files));
    text += section("Figure 6: loss by term", paper_terms_table(files));
    text += "\n![Energies by term and frame](figure_6.svg)\n";
    text += section("Figure 7: sampled neighbours", paper_neighbours_table(files));
    text += "\n![Gap against the number of neighbours](figure_7.svg)\n";
    return text;
}

}  // namespace cloth
