#include "render/image.h"

#include <gtest/gtest.h>

#include "data/core/errors.h"
#include "tests/render/temporary_folder.h"

namespace cloth::test {
namespace {

Image colourful(int width, int height) {
    Image image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            image.at(x, y) = {static_cast<std::uint8_t>(7 * x + y),
                              static_cast<std::uint8_t>(x + 11 * y),
                              static_cast<std::uint8_t>(255 - 3 * x * y)};
    return image;
}

bool equal(const Image& a, const Image& b) {
    if (a.width() != b.width() || a.height() != b.height()) return false;
    for (int y = 0; y < a.height(); ++y)
        for (int x = 0; x < a.width(); ++x)
            if (a.at(x, y) != b.at(x, y)) return false;
    return true;
}

TEST(Image, PngKeepsEveryPixel) {
    const TemporaryFolder folder;
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(37, 23), std::pair(64, 2)}) {
        const Image image = colourful(width, height);
        write_png(folder.file("a.png"), image);
        EXPECT_TRUE(equal(read_png(folder.file("a.png")), image)) << width << " x " << height;
    }
    EXPECT_EQ(folder.file_count(), 1u) << "a temporary file was left behind";
}

TEST(Image, PngWithoutFolderIsRefusedByName) {
    const std::string path = "/nonexistent_folder/a.png";
    const std::string message = message_of<LoadError>([&] { write_png(path, Image(2, 2)); });
    EXPECT_NE(message.find(path), std::string::npos) << message;
    EXPECT_NE(message.find("Remedy"), std::string::npos) << message;
    EXPECT_THROW(write_png("a.png", Image()), ArgumentError);
}

TEST(Image, FailedWriteKeepsTheOldFile) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.file("taken.png"));
    EXPECT_THROW(write_png(folder.file("taken.png"), Image(2, 2)), LoadError);
    EXPECT_TRUE(std::filesystem::is_directory(folder.file("taken.png")));
    EXPECT_EQ(folder.file_count(), 1u) << "a temporary file was left behind";
}

TEST(Image, BrokenPngsAreRefusedByName) {
    const TemporaryFolder folder;
    write_png(folder.file("good.png"), colourful(50, 40));
    const std::string good = content_of(folder.file("good.png"));
    std::string flipped = good;
    flipped[good.size() / 2] = static_cast<char>(~flipped[good.size() / 2]);
    const std::string broken[] = {folder.file("missing.png"), folder.write("empty.png", ""),
                                  folder.write("text.png", "This is not a picture."),
                                  folder.write("short.png", good.substr(0, good.size() / 2)),
                                  folder.write("flipped.png", flipped)};
    for (const std::string& path : broken) {
        const std::string message = message_of<LoadError>([&] { read_png(path); });
        EXPECT_NE(message.find(path), std::string::npos) << path << ": " << message;
        EXPECT_NE(message.find("Remedy"), std::string::npos) << message;
    }
}

TEST(Image, SizesOutOfRangeAreRefused) {
    EXPECT_THROW(Image(0, 4), ArgumentError);
    EXPECT_THROW(Image(4, -1), ArgumentError);
    EXPECT_THROW(Image(20000, 4), ArgumentError);
}

TEST(Image, HalvingAveragesSquaresOfFourPixels) {
    Image image(5, 2, {100, 100, 100});
    image.at(0, 0) = {0, 10, 255};
    image.at(1, 0) = {2, 10, 255};
    image.at(0, 1) = {4, 10, 255};
    image.at(1, 1) = {6, 10, 255};
    const Image half = halved(image);
    EXPECT_EQ(half.width(), 2);
    EXPECT_EQ(half.height(), 1);
    EXPECT_EQ(half.at(0, 0), (Rgb{3, 10, 255}));
    EXPECT_EQ(half.at(1, 0), (Rgb{100, 100, 100}));
}

TEST(Image, PasteLeavesOutWhatDoesNotFit) {
    const Image stamp(3, 3, {9, 9, 9});
    Image image(6, 5);
    paste(stamp, -1, -2, image);
    paste(stamp, 5, 4, image);
    paste(stamp, 6, 0, image);
    int painted = 0;
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 6; ++x) painted += image.at(x, y) == Rgb{9, 9, 9};
    EXPECT_EQ(painted, 2 + 1);
    EXPECT_EQ(image.at(1, 0), (Rgb{9, 9, 9}));
    EXPECT_EQ(image.at(5, 4), (Rgb{9, 9, 9}));
}

}  // namespace
}  // namespace cloth::test
