#include "render/montage.h"

#include <gtest/gtest.h>

#include "data/core/errors.h"

namespace cloth::test {
namespace {

TEST(Montage, PanelsFillTheGridRowByRow) {
    std::vector<Image> panels;
    for (int i = 0; i < 5; ++i)
        panels.emplace_back(40, 30, Rgb{static_cast<std::uint8_t>(50 * i), 1, 2});
    MontageSettings settings;
    settings.columns = 3;
    settings.gap = 4;
    const Image image = montage(panels, {}, settings);
    EXPECT_EQ(image.width(), 3 * 40 + 2 * 4);
    EXPECT_EQ(image.height(), 2 * 30 + 4);
    for (int i = 0; i < 5; ++i)
        EXPECT_EQ(image.at(i % 3 * 44 + 20, i / 3 * 34 + 15).r, 50 * i) << "panel " << i;
    EXPECT_EQ(image.at(41, 10), settings.background) << "gap";
    EXPECT_EQ(image.at(2 * 44 + 20, 34 + 15), settings.background) << "free place";
}

TEST(Montage, SizesAreEvenForVideos) {
    const Image image = montage({Image(33, 17), Image(33, 17)}, {}, {2, 5, 24, {}, {}});
    EXPECT_EQ(image.width() % 2, 0);
    EXPECT_EQ(image.height() % 2, 0);
}

TEST(Montage, CaptionsStandAbovePanels) {
    const MontageSettings settings;
    const std::vector<Image> panels(2, Image(200, 100, {0, 0, 255}));
    const Image image = montage(panels, {"bullet", "fast"}, settings);
    const int caption = image.height() - 100;
    int ink[2] = {0, 0};
    for (int y = 0; y < caption; ++y)
        for (int x = 0; x < image.width(); ++x)
            ink[x >= image.width() / 2] += image.at(x, y) == settings.caption;
    EXPECT_GT(ink[0], 30);
    EXPECT_GT(ink[1], 20);
    EXPECT_EQ(image.at(100, image.height() - 1), (Rgb{0, 0, 255}));
}

TEST(Montage, LongCaptionsStayAboveTheirPanels) {
    const MontageSettings settings;
    const std::vector<Image> panels(2, Image(200, 100, {0, 0, 255}));
    const std::string path = "/home/somebody/garments/of/mine/skirt.obj";
    const Image image = montage(panels, {path, path}, settings);
    for (int y = 0; y < image.height() - 100; ++y)
        for (int x = 200; x < 200 + settings.gap; ++x)
            ASSERT_EQ(image.at(x, y), settings.background) << "between the captions";
}

TEST(Montage, ChoosesColumnsForAWidePicture) {
    const auto columns = [](int count) {
        const Image image =
            montage(std::vector<Image>(count, Image(64, 72)), {}, {0, 0, 24, {}, {}});
        return image.width() / 64;
    };
    EXPECT_EQ(columns(1), 1);
    EXPECT_EQ(columns(2), 2);
    EXPECT_EQ(columns(6), 3);
    EXPECT_EQ(columns(8), 4);
}

TEST(Montage, UnusableInputIsRefused) {
    EXPECT_THROW(montage({}), ArgumentError);
    EXPECT_THROW(montage({Image()}), ArgumentError);
    EXPECT_THROW(montage({Image(4, 4)}, {"a", "b"}), ArgumentError);
    EXPECT_THROW(montage({Image(4, 4)}, {}, {-1, 4, 24, {}, {}}), ArgumentError);
}

}  // namespace
}  // namespace cloth::test
