#pragma once

#include <string>
#include <vector>

#include "render/image.h"

namespace cloth {

struct MontageSettings {
    int columns = 0;  ///< panels per row, 0 to 1000; 0: as shows them largest on a 16:9 screen
    int gap = 4;      ///< between the panels (pixels), 0 to 200
    int caption_height = 24;  ///< size of the captions' font (pixels), 8 to 200
    Rgb background = {24, 27, 34};
    Rgb caption = {235, 238, 242};
};

/// Pictures side by side, row after row. All panels have the size of the largest; the result has an
/// even width and height, as videos need.
/// @param captions  one line of text above each panel, or empty; what is too long is shortened
/// @throws ArgumentError if there is no panel, an empty panel or a wrong number of captions
/// @throws LoadError if captions are asked for and the font is missing
Image montage(const std::vector<Image>& panels, const std::vector<std::string>& captions = {},
              const MontageSettings& settings = {});

}  // namespace cloth
