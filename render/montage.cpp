#include "render/montage.h"

#include <algorithm>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "render/text.h"

namespace cloth {

namespace {

struct Layout {
    int columns;
    int rows;
    int panel_width;
    int panel_height;  ///< with the caption
    int caption;       ///< height of the caption
};

/// The number of columns that shows panels largest on a screen of 16:9.
int best_columns(int count, int panel_width, int panel_height) {
    int best = 1;
    double best_scale = 0.0;
    for (int columns = 1; columns <= count; ++columns) {
        const int rows = (count + columns - 1) / columns;
        const double scale = std::min(16.0 / (columns * panel_width), 9.0 / (rows * panel_height));
        if (scale > best_scale) {
            best = columns;
            best_scale = scale;
        }
    }
    return best;
}

void check(const std::vector<Image>& panels, const std::vector<std::string>& captions,
           const MontageSettings& settings) {
    if (panels.empty()) throw ArgumentError("montage", "there is no panel", "pass at least one");
    for (std::size_t i = 0; i < panels.size(); ++i)
        if (panels[i].empty())
            throw ArgumentError("montage", "panel " + std::to_string(i) + " is an empty picture",
                                "render it first");
    if (!captions.empty() && captions.size() != panels.size())
        throw ArgumentError("montage",
                            std::to_string(captions.size()) + " captions for " +
                                std::to_string(panels.size()) + " panels",
                            "pass one caption per panel, or none");
    check_range("MontageSettings.columns", settings.columns, 0, 1000);
    check_range("MontageSettings.gap", settings.gap, 0, 200);
    check_range("MontageSettings.caption_height", settings.caption_height, 8, 200);
}

Layout layout_of(const std::vector<Image>& panels, bool captions, const MontageSettings& settings) {
    Layout layout{};
    for (const Image& panel : panels) {
        layout.panel_width = std::max(layout.panel_width, panel.width());
        layout.panel_height = std::max(layout.panel_height, panel.height());
    }
    layout.caption = captions ? 3 * settings.caption_height / 2 : 0;
    layout.panel_height += layout.caption;
    const int count = static_cast<int>(panels.size());
    layout.columns = settings.columns > 0
                         ? std::min(settings.columns, count)
                         : best_columns(count, layout.panel_width, layout.panel_height);
    layout.rows = (count + layout.columns - 1) / layout.columns;
    return layout;
}

int even(int value) {
    return value + value % 2;
}

}  // namespace

Image montage(const std::vector<Image>& panels, const std::vector<std::string>& captions,
              const MontageSettings& settings) {
    check(panels, captions, settings);
    const Layout layout = layout_of(panels, !captions.empty(), settings);
    const int step_x = layout.panel_width + settings.gap;
    const int step_y = layout.panel_height + settings.gap;
    Image result(even(layout.columns * step_x - settings.gap),
                 even(layout.rows * step_y - settings.gap), settings.background);
    for (int i = 0; i < static_cast<int>(panels.size()); ++i)
        paste(panels[i], i % layout.columns * step_x, i / layout.columns * step_y + layout.caption,
              result);
    if (captions.empty()) return result;

    const Font font;
    for (int i = 0; i < static_cast<int>(captions.size()); ++i) {
        const int room = layout.panel_width - settings.caption_height / 2;
        const std::string caption = font.shortened(captions[i], settings.caption_height, room);
        const TextSize size = font.measure(caption, settings.caption_height);
        const int x = i % layout.columns * step_x + (layout.panel_width - size.width) / 2;
        const int y = i / layout.columns * step_y + (layout.caption - size.height) / 2;
        font.draw(caption, x, y, settings.caption_height, settings.caption, result);
    }
    return result;
}

}  // namespace cloth
