#include "render/plot.h"

#include <algorithm>
#include <array>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "render/label_placement.h"

namespace cloth {

namespace {

constexpr char kInk[] = "#333";
constexpr char kGrid[] = "#e3e3e3";

constexpr double kLetter = 6.8;  ///< mean width of one (pixels)

/// Where the diagram is within the picture (pixels).
struct Frame {
    double left, right, top, bottom;
};

struct Diagram {
    Axis x;
    Axis y;
    Frame frame;

    bool can_show(double vx, double vy) const { return x.can_show(vx) && y.can_show(vy); }
    double at_x(double value) const {
        return frame.left + x.position(value) * (frame.right - frame.left);
    }
    double at_y(double value) const {
        return frame.bottom - y.position(value) * (frame.bottom - frame.top);
    }
};

std::string number(double value) {
    return fixed_text(value, 2);
}

std::string attribute(const std::string& name, const std::string& value) {
    return " " + name + "=\"" + value + "\"";
}

std::string attribute(const std::string& name, double value) {
    return attribute(name, number(value));
}

std::string line_element(double x1, double y1, double x2, double y2, const std::string& more) {
    return "<line" + attribute("x1", x1) + attribute("y1", y1) + attribute("x2", x2) +
           attribute("y2", y2) + more + "/>\n";
}

std::string text_element(double x, double y, const std::string& text, const std::string& anchor,
                         const std::string& more = "") {
    return "<text" + attribute("x", x) + attribute("y", y) + attribute("text-anchor", anchor) +
           more + ">" + escaped(text) + "</text>\n";
}

void check(const std::vector<Series>& series, const PlotSettings& settings) {
    check_range("PlotSettings.width", settings.width, 200, 4000);
    check_range("PlotSettings.height", settings.height, 120, 4000);
    for (const Series& s : series) {
        if (s.x.size() != s.y.size() || (!s.texts.empty() && s.texts.size() != s.x.size()))
            throw ArgumentError("series '" + s.name + "'",
                                std::to_string(s.x.size()) + " x, " + std::to_string(s.y.size()) +
                                    " y and " + std::to_string(s.texts.size()) + " texts",
                                "pass as many y as x, and as many texts or none");
    }
}

constexpr int kLegendLine = 19;

int top_of(const PlotSettings& settings) {
    return settings.title.empty() ? 14 : 34;
}

/// Where the last line of the legend ends.
int legend_end(const std::vector<Series>& series, const PlotSettings& settings) {
    const auto named = std::count_if(series.begin(), series.end(),
                                     [](const Series& s) { return !s.name.empty(); });
    return top_of(settings) + kLegendLine * static_cast<int>(named);
}

double legend_width(std::size_t letters) {
    return letters == 0 ? 20.0 : std::max(165.0, 46.0 + kLetter * static_cast<double>(letters));
}

Diagram diagram_of(const std::vector<Series>& series, const PlotSettings& settings) {
    std::vector<double> xs, ys;
    Axis scales[2];
    scales[0].scale = settings.x_scale;
    scales[1].scale = settings.y_scale;
    std::size_t legend = 0;  // letters
    for (const Series& s : series) {
        legend = std::max(legend, s.name.size());
        for (std::size_t i = 0; i < s.x.size(); ++i) {
            if (!scales[0].can_show(s.x[i]) || !scales[1].can_show(s.y[i])) continue;
            xs.push_back(s.x[i]);
            ys.push_back(s.y[i]);
        }
    }
    if (settings.y_from_zero && settings.y_scale == Scale::linear) ys.push_back(0.0);
    Diagram diagram;
    diagram.x = axis_for(xs, settings.x_scale, 8);
    diagram.y = axis_for(ys, settings.y_scale, settings.height / 50);
    diagram.frame = {62.0, settings.width - legend_width(legend),
                     static_cast<double>(top_of(settings)), settings.height - 46.0};
    // Measured values end where they end, not at the next tick.
    if (settings.x_scale == Scale::linear && !xs.empty()) {
        const auto [low, high] = std::minmax_element(xs.begin(), xs.end());
        if (*high > *low) {
            diagram.x.high = *high + 0.02 * (*high - *low);
            diagram.x.low = *low == 0.0 ? 0.0 : *low - 0.02 * (*high - *low);
        }
    }
    return diagram;
}

std::string axes_svg(const Diagram& diagram) {
    const Frame& f = diagram.frame;
    const std::string grid = attribute("stroke", kGrid);
    std::string svg;
    for (double tick : diagram.x.ticks) {
        if (tick < diagram.x.low || tick > diagram.x.high) continue;
        svg += line_element(diagram.at_x(tick), f.top, diagram.at_x(tick), f.bottom, grid);
        svg += text_element(diagram.at_x(tick), f.bottom + 16, tick_text(tick), "middle");
    }
    for (double tick : diagram.y.ticks) {
        svg += line_element(f.left, diagram.at_y(tick), f.right, diagram.at_y(tick), grid);
        svg += text_element(f.left - 6, diagram.at_y(tick) + 4, tick_text(tick), "end");
    }
    const std::string ink = attribute("stroke", kInk);
    return svg + line_element(f.left, f.bottom, f.right, f.bottom, ink) +
           line_element(f.left, f.top, f.left, f.bottom, ink);
}

std::string captions_svg(const Frame& f, const PlotSettings& settings) {
    const double middle_x = 0.5 * (f.left + f.right), middle_y = 0.5 * (f.top + f.bottom);
    std::string svg;
    if (!settings.title.empty())
        svg += text_element(f.left, 20, settings.title, "start",
                            attribute("font-weight", "bold") + attribute("font-size", "14"));
    if (!settings.x_label.empty())
        svg += text_element(middle_x, f.bottom + 36, settings.x_label, "middle");
    if (!settings.y_label.empty())
        svg += text_element(14, middle_y, settings.y_label, "middle",
                            attribute("transform", "rotate(-90 14 " + number(middle_y) + ")"));
    return svg;
}

/// The line in pieces: it is broken where a value cannot be shown.
std::string line_svg(const Diagram& diagram, const Series& series, const std::string& colour) {
    std::string path;
    bool drawing = false;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        const bool shown = diagram.can_show(series.x[i], series.y[i]);
        if (shown)
            path += (drawing ? "L" : "M") + number(diagram.at_x(series.x[i])) + " " +
                    number(diagram.at_y(series.y[i]));
        drawing = shown;
    }
    if (path.empty()) return "";
    return "<path" + attribute("d", path) + attribute("fill", "none") +
           attribute("stroke", colour) + attribute("stroke-width", "1.8") +
           attribute("stroke-linejoin", "round") +
           (series.dashed ? attribute("stroke-dasharray", "6 4") : "") + "/>\n";
}

std::string marker_svg(double x, double y, Marker marker, const std::string& colour,
                       const std::string& title) {
    const std::string inner = title.empty() ? "" : "<title>" + escaped(title) + "</title>";
    if (marker == Marker::disc)
        return "<circle" + attribute("cx", x) + attribute("cy", y) + attribute("r", 4.0) +
               attribute("fill", colour) + ">" + inner + "</circle>\n";
    const double arm = 4.5;
    const std::string path = "M" + number(x - arm) + " " + number(y - arm) + "L" + number(x + arm) +
                             " " + number(y + arm) + "M" + number(x - arm) + " " + number(y + arm) +
                             "L" + number(x + arm) + " " + number(y - arm);
    return "<path" + attribute("class", "cross") + attribute("d", path) +
           attribute("fill", "none") + attribute("stroke", colour) +
           attribute("stroke-width", "2") + ">" + inner + "</path>\n";
}

std::string points_svg(const Diagram& diagram, const Series& series, const std::string& colour) {
    std::string svg;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        if (!diagram.can_show(series.x[i], series.y[i])) continue;
        const std::string name = series.texts.empty() ? series.name : series.texts[i];
        svg +=
            marker_svg(diagram.at_x(series.x[i]), diagram.at_y(series.y[i]), series.marker, colour,
                       name + ": " + tick_text(series.x[i]) + ", " + tick_text(series.y[i]));
    }
    return svg;
}

/// The texts of all points, beside them and clear of each other.
std::string texts_svg(const Diagram& diagram, const std::vector<Series>& series,
                      const std::vector<std::string>& colours) {
    const double height = 11.0, radius = 4.0;
    const Frame& f = diagram.frame;
    LabelPlacement placement({f.left, f.top, f.right, f.bottom});
    const auto for_each_point = [&](const auto& work) {
        for (std::size_t s = 0; s < series.size(); ++s)
            for (std::size_t i = 0; i < series[s].texts.size(); ++i)
                if (diagram.can_show(series[s].x[i], series[s].y[i]))
                    work(s, i, diagram.at_x(series[s].x[i]), diagram.at_y(series[s].y[i]));
    };
    for_each_point([&](std::size_t, std::size_t, double x, double y) {
        placement.block({x - radius, y - radius, x + radius, y + radius});
    });
    std::string svg;
    for_each_point([&](std::size_t s, std::size_t i, double x, double y) {
        const std::string& text = series[s].texts[i];
        const Box box = placement.place(x, y, kLetter * static_cast<double>(text.size()), height);
        svg += text_element(0.5 * (box.left + box.right), box.bottom - 1.5, text, "middle",
                            attribute("fill", colours[s]) + attribute("font-size", "11") +
                                attribute("paint-order", "stroke") + attribute("stroke", "#fff") +
                                attribute("stroke-width", "2.5"));
    });
    return svg;
}

std::string legend_svg(const Frame& f, const std::vector<Series>& series,
                       const std::vector<std::string>& colours) {
    std::string svg;
    double y = f.top + 8;
    for (std::size_t i = 0; i < series.size(); ++i) {
        if (series[i].name.empty()) continue;
        const double x = f.right + 14;
        if (series[i].style == SeriesStyle::points)
            svg += marker_svg(x + 10, y - 4, series[i].marker, colours[i], "");
        else
            svg += line_element(x, y - 4, x + 20, y - 4,
                                attribute("stroke", colours[i]) + attribute("stroke-width", "3") +
                                    (series[i].dashed ? attribute("stroke-dasharray", "6 4") : ""));
        svg += text_element(x + 26, y, series[i].name, "start");
        y += kLegendLine;
    }
    return svg;
}

}  // namespace

std::string category_colour(int k) {
    static const std::array<const char*, 8> kColours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                        "#e69f00", "#56b4e9", "#000000", "#a89f00"};
    return kColours[static_cast<std::size_t>(k) % kColours.size()];
}

std::string escaped(const std::string& text) {
    std::string result;
    for (char c : text) {
        switch (c) {
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '&':
                result += "&amp;";
                break;
            case '"':
                result += "&quot;";
                break;
            case '\'':
                result += "&#39;";
                break;
            default:
                result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        }
    }
    return result;
}

std::string plot_svg(const std::vector<Series>& series, const PlotSettings& asked) {
    check(series, asked);
    PlotSettings settings = asked;
    settings.height = std::max(asked.height, legend_end(series, asked));
    const Diagram diagram = diagram_of(series, settings);
    std::vector<std::string> colours;
    for (const Series& s : series)
        colours.push_back(s.colour.empty() ? category_colour(static_cast<int>(colours.size()))
                                           : escaped(s.colour));
    const std::string size = std::to_string(settings.width) + " " + std::to_string(settings.height);
    std::string svg = "<svg" + attribute("xmlns", "http://www.w3.org/2000/svg") +
                      attribute("viewBox", "0 0 " + size) + attribute("width", settings.width) +
                      attribute("height", settings.height) +
                      attribute("font-family", "DejaVu Sans, Helvetica, Arial, sans-serif") +
                      attribute("font-size", "12") + attribute("fill", kInk) + ">\n" +
                      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
    svg += axes_svg(diagram) + captions_svg(diagram.frame, settings);
    for (std::size_t i = 0; i < series.size(); ++i) {
        if (series[i].style != SeriesStyle::points) svg += line_svg(diagram, series[i], colours[i]);
        if (series[i].style != SeriesStyle::line) svg += points_svg(diagram, series[i], colours[i]);
    }
    svg += texts_svg(diagram, series, colours);
    return svg + legend_svg(diagram.frame, series, colours) + "</svg>\n";
}

}  // namespace cloth
