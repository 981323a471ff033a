#pragma once

#include <string>
#include <vector>

#include "render/image.h"

namespace cloth {

struct LookbookSettings {
    std::vector<std::string> garments;  ///< of garment_names()
    std::string motion = "01_01";       ///< as load_motion_by_name() takes it
    int frames = 90;                    ///< of 1/30 s into the motion, 1 to 100000; its end at most
};

/// A row for each garment: on the default body as it is put on, then after some frames of the
/// motion on the default body and, where body shapes are at hand, on two others. Ten quasi-Newton
/// iterations move the garments, without a network and without pins.
/// @throws LoadError, UsageError if a garment or the motion cannot be had
Image lookbook(const LookbookSettings& settings);

}  // namespace cloth
