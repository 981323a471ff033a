#include "render/text.h"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <fstream>
#include <sstream>
#include <vector>

#include "data/core/check_range.h"
#include "data/core/errors.h"

namespace cloth {

namespace {

constexpr char kDefaultFont[] = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

/// The code points of UTF-8 text; a broken sequence gives the replacement character.
std::vector<unsigned long> code_points(const std::string& text) {
    std::vector<unsigned long> points;
    for (std::size_t i = 0; i < text.size();) {
        const auto lead = static_cast<unsigned char>(text[i++]);
        const int more = lead < 0x80 ? 0 : lead < 0xC0 ? -1 : lead < 0xE0 ? 1 : lead < 0xF0 ? 2 : 3;
        unsigned long point = more <= 0 ? lead : lead & (0x3FUL >> more);
        bool valid = more >= 0;
        for (int k = 0; valid && k < more; ++k) {
            valid = i < text.size() && (static_cast<unsigned char>(text[i]) & 0xC0) == 0x80;
            if (valid) point = (point << 6) | (static_cast<unsigned char>(text[i++]) & 0x3FUL);
        }
        points.push_back(valid ? point : 0xFFFD);
    }
    return points;
}

std::uint8_t mixed(int below, int above, int alpha) {
    return static_cast<std::uint8_t>((below * (255 - alpha) + above * alpha + 127) / 255);
}

void blend(Rgb colour, int alpha, Rgb& pixel) {
    pixel = {mixed(pixel.r, colour.r, alpha), mixed(pixel.g, colour.g, alpha),
             mixed(pixel.b, colour.b, alpha)};
}

void blend_bitmap(const FT_Bitmap& bitmap, int left, int top, Rgb colour, Image& image) {
    for (int row = 0; row < static_cast<int>(bitmap.rows); ++row) {
        for (int column = 0; column < static_cast<int>(bitmap.width); ++column) {
            const int x = left + column, y = top + row;
            if (x < 0 || y < 0 || x >= image.width() || y >= image.height()) continue;
            blend(colour, bitmap.buffer[row * bitmap.pitch + column], image.at(x, y));
        }
    }
}

void blend_rectangle(int x0, int y0, TextSize size, Rgb colour, int alpha, Image& image) {
    for (int y = std::max(0, y0); y < std::min(image.height(), y0 + size.height); ++y)
        for (int x = std::max(0, x0); x < std::min(image.width(), x0 + size.width); ++x)
            blend(colour, alpha, image.at(x, y));
}

}  // namespace

struct Font::Face {
    std::string path;
    FT_Library library = nullptr;
    FT_Face face = nullptr;

    ~Face() {
        if (face) FT_Done_Face(face);
        if (library) FT_Done_FreeType(library);
    }

    void set_size(int pixels) const {
        check_range("text height (pixels)", pixels, 8, 200);
        if (FT_Set_Pixel_Sizes(face, 0, static_cast<FT_UInt>(pixels)))
            throw LoadError(path, "", "the font cannot be drawn at that size",
                            "choose a scalable TrueType font");
    }

    int line_height() const { return static_cast<int>((face->size->metrics.height + 32) >> 6); }
    int ascender() const { return static_cast<int>((face->size->metrics.ascender + 32) >> 6); }

    /// Loads one glyph; a glyph that cannot be drawn is skipped.
    bool load(unsigned long code_point) const {
        return FT_Load_Char(face, code_point, FT_LOAD_RENDER | FT_LOAD_TARGET_LIGHT) == 0;
    }
    int advance() const { return static_cast<int>((face->glyph->advance.x + 32) >> 6); }

    int width(const std::string& line) const {
        int width = 0;
        for (unsigned long point : code_points(line))
            if (load(point)) width += advance();
        return width;
    }
};

Font::Font(const std::string& path) : m_face(std::make_unique<Face>()) {
    m_face->path = path.empty() ? kDefaultFont : path;
    const std::string remedy = path.empty() ? "install the Debian package fonts-dejavu-core"
                                            : "pass the path of a TrueType font";
    if (!std::ifstream(m_face->path)) throw LoadError(m_face->path, "", "is missing", remedy);
    if (FT_Init_FreeType(&m_face->library) ||
        FT_New_Face(m_face->library, m_face->path.c_str(), 0, &m_face->face))
        throw LoadError(m_face->path, "", "is not a font that FreeType can read", remedy);
}

Font::~Font() = default;
Font::Font(Font&&) noexcept = default;
Font& Font::operator=(Font&&) noexcept = default;

TextSize Font::measure(const std::string& text, int pixels) const {
    m_face->set_size(pixels);
    TextSize size;
    for (const std::string& line : lines_of(text)) {
        size.width = std::max(size.width, m_face->width(line));
        size.height += m_face->line_height();
    }
    return size;
}

std::string Font::shortened(const std::string& text, int pixels, int width) const {
    if (measure(text, pixels).width <= width) return text;
    std::string beginning = text;
    while (!beginning.empty()) {
        // All bytes of a letter but its first one are 10xxxxxx.
        while ((static_cast<unsigned char>(beginning.back()) & 0xC0) == 0x80 &&
               beginning.size() > 1)
            beginning.pop_back();
        beginning.pop_back();
        if (measure(beginning + "...", pixels).width <= width) return beginning + "...";
    }
    return "";
}

void Font::draw(const std::string& text, int x, int y, int pixels, Rgb colour, Image& image) const {
    m_face->set_size(pixels);
    int baseline = y + m_face->ascender();
    for (const std::string& line : lines_of(text)) {
        int pen = x;
        for (unsigned long point : code_points(line)) {
            if (!m_face->load(point)) continue;
            const FT_GlyphSlot glyph = m_face->face->glyph;
            blend_bitmap(glyph->bitmap, pen + glyph->bitmap_left, baseline - glyph->bitmap_top,
                         colour, image);
            pen += m_face->advance();
        }
        baseline += m_face->line_height();
    }
}

void draw_label(const Font& font, const Label& label, Image& image) {
    const TextSize text = font.measure(label.text, label.text_height);
    const int border = label.text_height / 2;
    const TextSize plate{text.width + 2 * border, text.height + border};
    const bool right =
        label.corner == LabelCorner::top_right || label.corner == LabelCorner::bottom_right;
    const bool bottom =
        label.corner == LabelCorner::bottom_left || label.corner == LabelCorner::bottom_right;
    const int x = right ? image.width() - plate.width - border : border;
    const int y = bottom ? image.height() - plate.height - border : border;
    blend_rectangle(x, y, plate, {20, 24, 32}, 185, image);

    const std::size_t end = label.text.find('\n');
    const std::string heading = label.text.substr(0, end);
    font.draw(heading, x + border, y + border / 2, label.text_height, label.heading, image);
    if (end == std::string::npos) return;
    const int below = y + border / 2 + font.measure("x", label.text_height).height;
    font.draw(label.text.substr(end + 1), x + border, below, label.text_height, label.colour,
              image);
}

}  // namespace cloth
