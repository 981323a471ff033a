#include "render/image.h"

#include <png.h>

#include <algorithm>
#include <fstream>

#include "data/core/errors.h"
#include "render/replaced_file.h"

namespace cloth {

namespace {

constexpr int kMaxSize = 16384;

/// libpng's description of a picture; freed whatever happens.
struct PngHeader {
    png_image info{};
    PngHeader() { info.version = PNG_IMAGE_VERSION; }
    ~PngHeader() { png_image_free(&info); }
    PngHeader(const PngHeader&) = delete;
    PngHeader& operator=(const PngHeader&) = delete;
};

LoadError broken_png(const std::string& path, const png_image& info) {
    return LoadError(path, "", std::string("is not a readable PNG picture (") + info.message + ")",
                     "check that the file is complete and a PNG; make it again");
}

}  // namespace

Image::Image(int width, int height, Rgb fill) : m_width(width), m_height(height) {
    if (width < 1 || height < 1 || width > kMaxSize || height > kMaxSize)
        throw ArgumentError(
            "Image",
            "size " + std::to_string(width) + " x " + std::to_string(height) + " is out of range",
            "choose 1 to " + std::to_string(kMaxSize) + " pixels per side");
    m_pixels.assign(index(0, height), fill);
}

std::vector<std::uint8_t> encode_png(const Image& image) {
    if (image.empty())
        throw ArgumentError("encode_png", "the picture is empty", "render into it first");
    PngHeader header;
    header.info.width = static_cast<png_uint_32>(image.width());
    header.info.height = static_cast<png_uint_32>(image.height());
    header.info.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header.info);
    std::vector<std::uint8_t> png(size);
    if (!png_image_write_to_memory(&header.info, png.data(), &size, 0, image.bytes(), 0, nullptr))
        throw ArgumentError("encode_png", header.info.message, "reduce the size of the picture");
    png.resize(size);
    return png;
}

void write_png(const std::string& path, const Image& image) {
    const std::vector<std::uint8_t> png = encode_png(image);
    write_text_file(path, std::string(png.begin(), png.end()));
}

Image read_png(const std::string& path) {
    if (!std::ifstream(path))
        throw LoadError(path, "", "cannot be opened", "check the path and its permissions");
    PngHeader header;
    if (!png_image_begin_read_from_file(&header.info, path.c_str()))
        throw broken_png(path, header.info);
    if (header.info.width > kMaxSize || header.info.height > kMaxSize)
        throw LoadError(path, "header", "the picture has more than 16384 pixels on a side",
                        "scale it down");
    header.info.format = PNG_FORMAT_RGB;
    Image image(static_cast<int>(header.info.width), static_cast<int>(header.info.height));
    const png_color black{};
    if (!png_image_finish_read(&header.info, &black, image.bytes(), 0, nullptr))
        throw broken_png(path, header.info);
    return image;
}

Image halved(const Image& image) {
    Image half(image.width() / 2, image.height() / 2);
    for (int y = 0; y < half.height(); ++y) {
        for (int x = 0; x < half.width(); ++x) {
            const Rgb& a = image.at(2 * x, 2 * y);
            const Rgb& b = image.at(2 * x + 1, 2 * y);
            const Rgb& c = image.at(2 * x, 2 * y + 1);
            const Rgb& d = image.at(2 * x + 1, 2 * y + 1);
            half.at(x, y) = {static_cast<std::uint8_t>((a.r + b.r + c.r + d.r + 2) / 4),
                             static_cast<std::uint8_t>((a.g + b.g + c.g + d.g + 2) / 4),
                             static_cast<std::uint8_t>((a.b + b.b + c.b + d.b + 2) / 4)};
        }
    }
    return half;
}

void paste(const Image& picture, int x, int y, Image& target) {
    const int first = std::max(0, -x);
    const int last = std::min(picture.width(), target.width() - x);
    if (first >= last) return;
    for (int row = std::max(0, -y); row < std::min(picture.height(), target.height() - y); ++row)
        std::copy_n(&picture.at(first, row), last - first, &target.at(x + first, y + row));
}

}  // namespace cloth
