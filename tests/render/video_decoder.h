#pragma once

#include <string>
#include <vector>

#include "render/image.h"

namespace cloth::test {

struct DecodedVideo {
    std::vector<Image> frames;
    double fps = 0.0;
    std::string codec;
    std::string pixel_format;
};

/// Decodes all of a video. @throws std::runtime_error with ffmpeg's reason
DecodedVideo decode_video(const std::string& path);

}  // namespace cloth::test
