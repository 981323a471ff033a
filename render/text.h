#pragma once

#include <memory>
#include <string>

#include "render/image.h"
#include "render/scene.h"

namespace cloth {

/// Width and height of a piece of text (pixels).
struct TextSize {
    int width = 0;
    int height = 0;
};

/// Draws anti-aliased text into pictures.
///
///     Font font;
///     font.draw("fast+2\n12 ms per frame", 8, 8, 22, {255, 255, 255}, image);
class Font {
 public:
    /// @param path  a TrueType file; empty: DejaVu Sans where Debian keeps it
    /// @throws LoadError naming the file or the Debian package that is missing
    explicit Font(const std::string& path = "");
    ~Font();
    Font(Font&&) noexcept;
    Font& operator=(Font&&) noexcept;

    /// Size of text (UTF-8, '\n' begins a new line) at a font height of `pixels`.
    /// @throws ArgumentError unless pixels is 8 to 200
    TextSize measure(const std::string& text, int pixels) const;

    /// The text as it is if it is at most `width` pixels wide, else its beginning with "..." behind
    /// it; empty if not even these fit.
    /// @param text  a single line (UTF-8)
    std::string shortened(const std::string& text, int pixels, int width) const;

    /// Draws text with its top left corner at (x, y); what lies outside of the picture is left out.
    void draw(const std::string& text, int x, int y, int pixels, Rgb colour, Image& image) const;

 private:
    struct Face;
    std::unique_ptr<Face> m_face;
};

/// Draws a label on its plate. @throws ArgumentError for a text height out of range
void draw_label(const Font& font, const Label& label, Image& image);

}  // namespace cloth
