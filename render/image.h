#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace cloth {

/// One colour as it is shown (sRGB), 0 to 255 per channel.
struct Rgb {
    std::uint8_t r = 0;
    std::uint8_t g = 0;
    std::uint8_t b = 0;
};

inline bool operator==(Rgb a, Rgb b) {
    return a.r == b.r && a.g == b.g && a.b == b.b;
}
inline bool operator!=(Rgb a, Rgb b) {
    return !(a == b);
}

/// A picture (height x width pixels, sRGB), first row on top.
class Image {
 public:
    Image() = default;

    /// @throws ArgumentError unless width and height are 1 to 16384
    Image(int width, int height, Rgb fill = {});

    int width() const { return m_width; }
    int height() const { return m_height; }
    bool empty() const { return m_pixels.empty(); }

    Rgb& at(int x, int y) { return m_pixels[index(x, y)]; }
    const Rgb& at(int x, int y) const { return m_pixels[index(x, y)]; }

    /// 3 width height bytes, row after row without padding.
    std::uint8_t* bytes() { return &m_pixels[0].r; }
    const std::uint8_t* bytes() const { return &m_pixels[0].r; }

 private:
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(m_width) +
               static_cast<std::size_t>(x);
    }

    int m_width = 0;
    int m_height = 0;
    std::vector<Rgb> m_pixels;
};

static_assert(sizeof(Rgb) == 3, "Image::bytes() promises three bytes per pixel");

/// The picture as the bytes of a PNG file. @throws ArgumentError for an empty picture
std::vector<std::uint8_t> encode_png(const Image& image);

/// Writes a PNG file, whole or not at all. @throws LoadError naming the file
void write_png(const std::string& path, const Image& image);

/// Reads a PNG file of any kind; transparent parts become black.
/// @throws LoadError naming the file, what is wrong with it and the remedy
Image read_png(const std::string& path);

/// The picture at half width and height, each pixel the mean of 2 x 2 (odd last row and column
/// are left out).
Image halved(const Image& image);

/// The picture `picture` copied into `target` with its top left corner at (x, y); what lies
/// outside of `target` is left out.
void paste(const Image& picture, int x, int y, Image& target);

}  // namespace cloth
