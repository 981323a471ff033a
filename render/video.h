#pragma once

#include <memory>
#include <string>

#include "render/image.h"

namespace cloth {

struct VideoSettings {
    double fps = 30.0;  ///< pictures per second, 1 to 240
    int quality = 20;   ///< x264's constant rate factor, 0 (lossless) to 51; 18 to 24 looks good
    int key_frame_interval = 30;  ///< pictures between two that a player can jump to, 1 to 600
};

/// Writes an H.264 MP4 file that browsers play while it loads. Equal pictures give equal bytes with
/// the same version of the encoder.
///
///     VideoWriter video("comparison.mp4", 1280, 720);
///     for (const Image& image : images) video.add(image);
///     video.close();
///
/// The file appears at close(); without it (an exception, say) nothing is left behind.
class VideoWriter {
 public:
    /// @param width, height  of every picture (pixels): even, 16 to 8192
    /// @throws ArgumentError for a size or setting out of range
    /// @throws LoadError if the file cannot be written or this ffmpeg has no H.264 encoder
    VideoWriter(const std::string& path, int width, int height, const VideoSettings& settings = {});
    ~VideoWriter();
    VideoWriter(const VideoWriter&) = delete;
    VideoWriter& operator=(const VideoWriter&) = delete;

    /// @throws ArgumentError if the picture has another size or the video is closed
    void add(const Image& image);

    /// Finishes the file and puts it in place; closing twice does nothing.
    /// @throws ArgumentError if no picture was added
    /// @throws LoadError if the disk is full or the path cannot be written
    void close();

    int frame_count() const;

 private:
    class Implementation;
    std::unique_ptr<Implementation> m_implementation;
};

}  // namespace cloth
