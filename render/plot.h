#pragma once

#include <string>
#include <vector>

#include "render/plot_axis.h"

namespace cloth {

enum class SeriesStyle { line, points, line_and_points };
enum class Marker { disc, cross };

/// Values that belong together: one line or one set of points.
struct Series {
    std::string name = {};  ///< in the legend; empty: not in the legend
    std::vector<double> x = {};
    std::vector<double> y = {};  ///< as many as x. What cannot be shown (not finite, or <= 0
                                 ///< on a logarithmic axis) leaves a gap in the line
    SeriesStyle style = SeriesStyle::line;
    std::string colour = {};  ///< as in CSS; empty: the next of category_colour()
    bool dashed = false;
    std::vector<std::string> texts = {};  ///< beside each point, or empty
    Marker marker = Marker::disc;         ///< of the points
};

struct PlotSettings {
    std::string title = {};
    std::string x_label = {};  ///< with the unit: "time (s)"
    std::string y_label = {};
    int width = 760;   ///< (pixels), 200 to 4000
    int height = 320;  ///< (pixels), 120 to 4000; the plot is higher where its legend is
    Scale x_scale = Scale::linear;
    Scale y_scale = Scale::linear;
    bool y_from_zero = true;  ///< a linear y axis includes 0
};

/// Colour k of eight that colour-blind people can tell apart (Okabe and Ito 2008), as in CSS; the
/// ninth is the first again.
std::string category_colour(int k);

/// A diagram with axes, ticks, grid and legend as an SVG element that stands alone or inside HTML.
///
///     write_text_file("error.svg", plot_svg({{"fast", seconds, error_mm}}, settings));
///
/// Equal input gives equal text.
/// @throws ArgumentError if a series has unequal numbers of x, y or texts, or a size is out of
/// range
std::string plot_svg(const std::vector<Series>& series, const PlotSettings& settings);

/// Text for HTML and XML: < > & " ' are written as entities, control characters as spaces.
std::string escaped(const std::string& text);

}  // namespace cloth
