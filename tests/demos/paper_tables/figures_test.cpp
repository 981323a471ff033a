#include "demos/paper_tables/figures.h"

#include <gtest/gtest.h>

#include "demos/paper_tables/page.h"

namespace cloth::paper_figures_test {

namespace {

using Json = nlohmann::ordered_json;

Json terms(double strain) {
    return {{"strain", strain}, {"bending", 0.5},    {"contact", nullptr},
            {"gravity", -1.0},  {"inertia", 0.0625}, {"friction", 2.0}};
}

/// Two solvers by term, one without; two seeds of one training and a third one.
Json report() {
    return {{"provenance",
             {{"commit", "0123456789"},
              {"machine", "a loom"},
              {"threads", 2},
              {"date", "2026-12-31"},
              {"note", "It rained."}}},
            {"rows",
             {{{"garment", "tshirt"},
               {"solver", "fast+0"},
               {"terms", {terms(0.25), terms(4)}},
               {"first_failed_frame", nullptr}},
              {{"garment", "tshirt"},
               {"solver", "baseline+0"},
               {"terms", {terms(8)}},
               {"first_failed_frame", 1},
               {"failure", "not finite"}},
              {{"garment", "tshirt"}, {"solver", "hood+0"}, {"missing", "not trained yet"}}}},
            {"training", Json::array()},
            {"neighbours",
             {{{"name", "1"}, {"gap_tshirt_median", 0.5}},
              {{"name", "1"}, {"gap_tshirt_median", 0.7}},
              {{"name", "2"}, {"gap_tshirt_median", 0.4}}}}};
}

}  // namespace

TEST(PaperFigures, EnergiesAreATableFrameByFrame) {
    EXPECT_EQ(figure_6_csv(report()),
              "garment,solver,frame,strain,bending,contact,gravity,inertia,friction\n"
              "tshirt,fast+0,1,0.25,0.5,,-1.0,0.0625,2.0\n"
              "tshirt,fast+0,2,4.0,0.5,,-1.0,0.0625,2.0\n"
              "tshirt,baseline+0,1,8.0,0.5,,-1.0,0.0625,2.0\n");
}

TEST(PaperFigures, PlotsHaveTheirLines) {
    const std::string six = figure_6_svg(report(), "fast+0", "baseline+0");
    for (const char* line : {"fast+0: strain", "baseline+0: friction", "stroke-dasharray"})
        EXPECT_NE(six.find(line), std::string::npos) << line;
    const std::string seven = figure_7_svg(report());
    for (const char* line : {"sampled neighbours", "T-shirt, new motion", "sheets"})
        EXPECT_NE(seven.find(line), std::string::npos) << line;
    const Json nothing = {{"rows", Json::array()}};
    EXPECT_NE(figure_6_svg(nothing, "a", "b").find("<svg"), std::string::npos);
    EXPECT_NE(figure_7_svg(nothing).find("<svg"), std::string::npos);
}

TEST(PaperPage, HasAllTablesAndWhereTheyAreFrom) {
    const std::string page = paper_page("report.json", report());
    for (const char* part :
         {"Commit 0123456789; machine a loom; threads 2; date 2026-12-31. It rained.", "## Claims",
          "## Table 1", "## Table 2: tshirt", "## Table 3", "## Figure 6", "## Figure 7",
          "| hood+0 | 18.6 | – |", "not trained yet", "frame 1: not finite"})
        EXPECT_NE(page.find(part), std::string::npos) << part << "\n" << page;
}

}  // namespace cloth::paper_figures_test
