#include "render/plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <sstream>

#include "data/core/errors.h"
#include "render/label_placement.h"

namespace cloth::test {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

int count_of(const std::string& text, const std::string& part) {
    int count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++count;
    return count;
}

/// The path of the k-th line of a plot.
std::string path_of(const std::string& svg, int k = 0) {
    std::size_t at = svg.find("<path d=\"");
    for (; k > 0; --k) at = svg.find("<path d=\"", at + 1);
    return at == std::string::npos ? "" : svg.substr(at + 9, svg.find('"', at + 9) - at - 9);
}

/// The coordinates of a path, x and y in turn.
std::vector<double> numbers_of(std::string path) {
    std::replace_if(
        path.begin(), path.end(), [](char c) { return c == 'M' || c == 'L'; }, ' ');
    std::istringstream stream(path);
    return {std::istream_iterator<double>(stream), std::istream_iterator<double>()};
}

/// Every element is closed, in order: what an XML parser would insist on.
bool is_well_formed(const std::string& svg) {
    std::vector<std::string> open;
    for (std::size_t at = svg.find('<'); at != std::string::npos; at = svg.find('<', at + 1)) {
        const std::size_t end = svg.find('>', at);
        if (end == std::string::npos || svg.find('<', at + 1) < end) return false;
        const bool closing = svg[at + 1] == '/';
        const std::size_t start = at + (closing ? 2 : 1);
        const std::string name = svg.substr(start, svg.find_first_of(" />", start) - start);
        if (name.empty()) return false;
        if (!closing && svg[end - 1] != '/') open.push_back(name);
        if (!closing) continue;
        if (open.empty() || open.back() != name) return false;
        open.pop_back();
    }
    return open.empty();
}

TEST(PlotTest, ItsParserKnowsBrokenFromWhole) {
    EXPECT_TRUE(is_well_formed("<a b=\"c\"><d/>text</a>"));
    for (const char* broken : {"<a>", "<a><b></a></b>", "<a></a></a>", "<a <b>/>", "a < b"})
        EXPECT_FALSE(is_well_formed(broken)) << broken;
    EXPECT_EQ(numbers_of("M1 2.5L-3 4"), (std::vector<double>{1, 2.5, -3, 4}));
}

TEST(PlotAxis, LinearTicksAreRoundAndCoverTheValues) {
    const Axis axis = axis_for({0.3, 9.2, 17.9}, Scale::linear, 5);
    EXPECT_EQ(axis.ticks, (std::vector<double>{0, 5, 10, 15, 20}));
    EXPECT_EQ(axis.low, 0.0);
    EXPECT_EQ(axis.high, 20.0);
    EXPECT_DOUBLE_EQ(axis.position(5.0), 0.25);
}

TEST(PlotAxis, LogarithmicTicksArePowersOfTen) {
    const Axis axis = axis_for({0.02, 3000.0, -5.0, 0.0, kNan}, Scale::logarithmic, 6);
    EXPECT_EQ(axis.ticks.size(), 5u);
    EXPECT_NEAR(axis.ticks.front(), 0.1, 1e-15);
    EXPECT_NEAR(axis.ticks.back(), 1000.0, 1e-9);
    EXPECT_NEAR(axis.position(std::sqrt(axis.low * axis.high)), 0.5, 1e-12);
    EXPECT_FALSE(axis.can_show(0.0));
}

TEST(PlotAxis, NarrowLogarithmicRangesHaveTicksBetweenDecades) {
    EXPECT_GE(axis_for({3.0, 30.0}, Scale::logarithmic).ticks.size(), 3u);
}

TEST(PlotAxis, EqualOrNoValuesStillMakeAnAxis) {
    for (const std::vector<double>& values :
         {std::vector<double>{}, {7.0, 7.0}, {0.0}, {-3.0}, {kNan}, {1e-9, 1e-9}}) {
        for (Scale scale : {Scale::linear, Scale::logarithmic}) {
            const Axis axis = axis_for(values, scale);
            EXPECT_LT(axis.low, axis.high);
            EXPECT_GE(axis.ticks.size(), 1u);
        }
    }
}

TEST(PlotAxis, TickTextsAreShort) {
    EXPECT_EQ(tick_text(0.0), "0");
    EXPECT_EQ(tick_text(3 * 0.1), "0.3");
    EXPECT_EQ(tick_text(2500.0), "2500");
    EXPECT_EQ(tick_text(1e7), "1e+07");
    EXPECT_EQ(tick_text(0.001), "0.001");
    EXPECT_EQ(fixed_text(2.5001, 2), "2.5");
    EXPECT_EQ(fixed_text(-0.0001, 2), "0");
    EXPECT_EQ(fixed_text(100.0, 2), "100");
}

TEST(Plot, PointsStandWhereTheirValuesAre) {
    PlotSettings settings;
    const std::string svg = plot_svg({{"a", {0, 1, 2}, {0, 10, 20}}}, settings);
    const std::vector<double> path = numbers_of(path_of(svg));
    ASSERT_EQ(path.size(), 6u);
    EXPECT_NEAR(path[2] - path[0], path[4] - path[2], 0.02) << "equal steps along x";
    EXPECT_NEAR(path[1] - path[3], path[3] - path[5], 0.02) << "equal steps along y";
    EXPECT_GT(path[1], path[3]) << "up is more";
    for (double value : path) {
        EXPECT_GE(value, 0.0);
        EXPECT_LE(value, settings.width);
    }
}

TEST(Plot, LogarithmicScaleMakesFactorsEqualSteps) {
    PlotSettings settings;
    settings.y_scale = Scale::logarithmic;
    const auto path = numbers_of(path_of(plot_svg({{"a", {0, 1, 2}, {1, 10, 100}}}, settings)));
    EXPECT_NEAR(path[1] - path[3], path[3] - path[5], 0.02);
    EXPECT_GT(path[1] - path[3], 40.0);
}

TEST(Plot, ValuesThatCannotBeShownLeaveGaps) {
    const Series series{"a", {0, 1, 2, 3, 4, 5}, {1, 2, kNan, 4, INFINITY, 5}};
    const std::string path = path_of(plot_svg({series}, {}));
    EXPECT_EQ(count_of(path, "M"), 3);
    EXPECT_EQ(count_of(path, "L"), 1);
    EXPECT_EQ(path.find("nan"), std::string::npos);
    EXPECT_EQ(path.find("inf"), std::string::npos);
    PlotSettings logarithmic;
    logarithmic.y_scale = Scale::logarithmic;
    EXPECT_EQ(count_of(path_of(plot_svg({{"a", {0, 1, 2}, {3, -1, 4}}}, logarithmic)), "M"), 2);
}

TEST(Plot, LegendNamesEverySeriesInItsColour) {
    const std::string svg =
        plot_svg({{"bullet", {0, 1}, {1, 2}}, {"fast", {0, 1}, {2, 3}}}, PlotSettings());
    for (const char* text : {">bullet</text>", ">fast</text>"})
        EXPECT_EQ(count_of(svg, text), 1) << text;
    EXPECT_GE(count_of(svg, category_colour(0)), 2) << "line and legend";
    EXPECT_GE(count_of(svg, category_colour(1)), 2);
    EXPECT_NE(category_colour(0), category_colour(1));
    EXPECT_EQ(category_colour(8), category_colour(0));
}

TEST(Plot, ALongLegendMakesItHigher) {
    const auto height_of = [](int names) {
        std::vector<Series> series(static_cast<std::size_t>(names), {"solver", {1, 2}, {3, 4}});
        const std::string svg = plot_svg(series, {});
        double lowest = 0.0;
        for (std::size_t at = svg.find(">solver<"); at != std::string::npos;
             at = svg.find(">solver<", at + 1)) {
            const std::size_t y = svg.rfind(" y=\"", at) + 4;
            lowest = std::max(lowest, std::stod(svg.substr(y)));
        }
        const double height = std::stod(svg.substr(svg.find(" height=\"") + 9));
        EXPECT_LT(lowest, height - 4) << names;
        return height;
    };
    EXPECT_EQ(height_of(3), 320);
    EXPECT_GT(height_of(40), 700);
}

TEST(Plot, ScatterHasOneCircleAndTextPerPoint) {
    Series series{"", {1, 10, 100}, {5, 6, 7}, SeriesStyle::points, "", false, {"a", "b", "c"}};
    PlotSettings settings;
    settings.x_scale = Scale::logarithmic;
    const std::string svg = plot_svg({series}, settings);
    EXPECT_EQ(count_of(svg, "<circle"), 3);
    for (const char* text : {">a</text>", ">b</text>", ">c</text>"})
        EXPECT_EQ(count_of(svg, text), 1) << text;
    EXPECT_EQ(count_of(svg, "<path"), 0);
}

TEST(Plot, TextIsEscapedAndTheElementsAreClosed) {
    PlotSettings settings;
    settings.title = "a < b & \"c\"";
    settings.x_label = "x <script>";
    settings.y_label = "y";
    Series series{"<b>", {0, 1, kNan}, {1, 2, 3}, SeriesStyle::line_and_points, "red", true, {}};
    const std::string svg = plot_svg({series, {}}, settings);
    EXPECT_TRUE(is_well_formed(svg)) << svg;
    EXPECT_EQ(svg.find("<script>"), std::string::npos);
    EXPECT_NE(svg.find("a &lt; b &amp; &quot;c&quot;"), std::string::npos);
}

TEST(Plot, EqualInputGivesEqualText) {
    const std::vector<Series> series{{"a", {0, 0.1, 0.7}, {1 / 3.0, 2.7, 1e-4}}};
    EXPECT_EQ(plot_svg(series, {}), plot_svg(series, {}));
}

TEST(Plot, UnusableInputIsRefusedByName) {
    EXPECT_THROW(plot_svg({{"a", {0, 1}, {1}}}, {}), ArgumentError);
    Series series{"a", {0, 1}, {1, 2}};
    series.texts = {"one"};
    EXPECT_THROW(plot_svg({series}, {}), ArgumentError);
    PlotSettings settings;
    settings.width = 10;
    EXPECT_THROW(plot_svg({}, settings), ArgumentError);
}

TEST(Plot, CrossesStandWhereDiscsWould) {
    Series series{"a", {1, 2}, {1, 2}, SeriesStyle::points};
    EXPECT_EQ(count_of(plot_svg({series}, {}), "<circle"), 3) << "two points and the legend";
    series.marker = Marker::cross;
    const std::string svg = plot_svg({series}, {});
    EXPECT_EQ(count_of(svg, "<circle"), 0);
    EXPECT_EQ(count_of(svg, "class=\"cross\""), 3);
    EXPECT_TRUE(is_well_formed(svg));
}

TEST(LabelPlacement, TextsHideNeitherPointsNorEachOther) {
    LabelPlacement placement({0, 0, 200, 200});
    std::vector<Box> boxes;
    for (double x : {100.0, 106.0, 112.0, 198.0}) {
        boxes.push_back({x - 4, 96, x + 4, 104});
        placement.block(boxes.back());
    }
    const std::size_t points = boxes.size();
    for (double x : {100.0, 106.0, 112.0, 198.0}) boxes.push_back(placement.place(x, 100, 20, 11));
    for (std::size_t text = points; text < boxes.size(); ++text) {
        EXPECT_LE(boxes[text].right, 200.0);
        for (std::size_t other = 0; other < text; ++other) {
            const bool apart =
                boxes[text].left >= boxes[other].right || boxes[text].right <= boxes[other].left ||
                boxes[text].top >= boxes[other].bottom || boxes[text].bottom <= boxes[other].top;
            EXPECT_TRUE(apart) << text << " " << other;
        }
    }
    LabelPlacement empty({0, 0, 200, 200});
    const Box first = empty.place(100, 100, 20, 11);
    EXPECT_EQ(first.left, 105.0) << "right above where that is free";
    EXPECT_EQ(first.bottom, 95.0);
}

}  // namespace
}  // namespace cloth::test
