#include "render/text.h"

#include <gtest/gtest.h>

#include "data/core/errors.h"
#include "tests/render/temporary_folder.h"

namespace cloth::test {
namespace {

const Rgb kInk = {255, 255, 255};

/// Box of all pixels that are not black.
struct Ink {
    int count = 0, solid = 0, left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
};

Ink ink_of(const Image& image) {
    Ink ink;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            if (image.at(x, y) == Rgb{}) continue;
            ++ink.count;
            ink.solid += image.at(x, y) == kInk;
            ink.left = std::min(ink.left, x);
            ink.right = std::max(ink.right, x);
            ink.top = std::min(ink.top, y);
            ink.bottom = std::max(ink.bottom, y);
        }
    }
    return ink;
}

TEST(Font, WhatIsTooLongIsShortenedBetweenLetters) {
    const Font font;
    EXPECT_EQ(font.shortened("skirt", 14, 240), "skirt");
    const std::string text = "ein sehr langer Name für Röcke";
    for (int width = 30; width < 240; width += 7) {
        const std::string cut = font.shortened(text, 14, width);
        EXPECT_LE(font.measure(cut, 14).width, width);
        if (cut == text) continue;
        ASSERT_GT(cut.size(), 3u) << width;
        EXPECT_EQ(cut.substr(cut.size() - 3), "...");
        const std::string rest = text.substr(cut.size() - 3);
        EXPECT_EQ(text.rfind(cut.substr(0, cut.size() - 3), 0), 0u) << cut;
        EXPECT_NE(static_cast<unsigned char>(rest[0]) & 0xC0, 0x80) << "cut within a letter";
    }
    EXPECT_EQ(font.shortened(text, 14, 3), "");
}

TEST(Font, InkFillsTheMeasuredBox) {
    const Font font;
    const std::string text = "Hfast+2\ngy 12.4 ms";
    const TextSize size = font.measure(text, 32);
    Image image(400, 200);
    font.draw(text, 20, 30, 32, kInk, image);
    const Ink ink = ink_of(image);
    EXPECT_GE(ink.left, 20);
    EXPECT_LE(ink.left, 25);
    EXPECT_LE(ink.right, 20 + size.width);
    EXPECT_GE(ink.right, 20 + size.width - 6);
    EXPECT_GE(ink.top, 30);
    EXPECT_LE(ink.bottom, 30 + size.height);
    EXPECT_GE(ink.bottom, 30 + size.height - 14);
    EXPECT_GT(ink.solid, ink.count / 4) << "letters need solid strokes to be readable";
    EXPECT_LT(ink.solid, ink.count) << "letters need soft borders";
}

TEST(Font, MoreTextIsLongerAndMoreLinesAreHigher) {
    const Font font;
    const TextSize one = font.measure("abc", 20), two = font.measure("abcabc", 20);
    const TextSize lines = font.measure("abc\nabc", 20);
    EXPECT_EQ(two.width, 2 * one.width);
    EXPECT_EQ(lines.width, one.width);
    EXPECT_EQ(lines.height, 2 * one.height);
    EXPECT_EQ(font.measure("", 20).width, 0);
}

TEST(Font, Utf8IsReadAsCharactersAndBrokenBytesDoNoHarm) {
    const Font font;
    EXPECT_EQ(font.measure("\xC2\xB5", 20).width, font.measure("\xCE\xBC", 20).width)
        << "micro sign and mu look alike";
    EXPECT_LT(font.measure("\xC2\xB5", 20).width, font.measure("mm", 20).width);
    Image image(60, 60);
    font.draw("\xC3\x28\xFF\xE2\x82", 5, 5, 20, kInk, image);
    EXPECT_GT(ink_of(image).count, 0);
}

TEST(Font, TextOutsideOfThePictureIsLeftOut) {
    const Font font;
    Image image(30, 30);
    font.draw("WWWW", -20, -10, 24, kInk, image);
    font.draw("WWWW", 25, 25, 24, kInk, image);
    font.draw("WWWW", 500, 500, 24, kInk, image);
    EXPECT_GT(ink_of(image).count, 0);
}

TEST(Font, UnusableFontsAndSizesAreRefused) {
    const TemporaryFolder folder;
    for (const std::string& path : {folder.file("missing.ttf"), folder.write("bad.ttf", "text")}) {
        const std::string message = message_of<LoadError>([&] { Font font(path); });
        EXPECT_NE(message.find(path), std::string::npos) << message;
    }
    EXPECT_THROW(Font().measure("a", 3), ArgumentError);
    EXPECT_THROW(Font().measure("a", 1000), ArgumentError);
}

TEST(Label, StandsInItsCornerWithAHeadingOfItsOwnColour) {
    const Font font;
    Label label;
    label.text = "HEADING\nline";
    label.colour = {0, 255, 0};
    label.heading = {255, 0, 0};
    label.corner = LabelCorner::bottom_right;
    Image image(400, 300, {90, 90, 90});
    draw_label(font, label, image);
    int red_rows = 0, green_rows = 0, red_below_green = 0;
    for (int y = 0; y < image.height(); ++y) {
        bool red = false, green = false;
        for (int x = 0; x < image.width(); ++x) {
            red = red || image.at(x, y) == label.heading;
            green = green || image.at(x, y) == label.colour;
            if (x < 200 || y < 150) {
                EXPECT_EQ(image.at(x, y), (Rgb{90, 90, 90}));
            }
        }
        red_rows += red;
        green_rows += green;
        red_below_green += red && green_rows > 0;
    }
    EXPECT_GE(red_rows, 10);
    EXPECT_GE(green_rows, 10);
    EXPECT_EQ(red_below_green, 0);
}

}  // namespace
}  // namespace cloth::test
