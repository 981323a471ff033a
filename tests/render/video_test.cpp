#include "render/video.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "data/core/errors.h"
#include "tests/render/temporary_folder.h"
#include "tests/render/video_decoder.h"

namespace cloth::test {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 96;

/// Left half in the colour of the frame, right half grey.
Image frame_of(int i) {
    const Rgb colours[] = {{200, 40, 40}, {40, 180, 60}, {50, 70, 210}};
    Image image(kWidth, kHeight, {128, 128, 128});
    paste(Image(kWidth / 2, kHeight, colours[i % 3]), 0, 0, image);
    return image;
}

void write_video(const std::string& path, int frames, const VideoSettings& settings = {}) {
    VideoWriter video(path, kWidth, kHeight, settings);
    for (int i = 0; i < frames; ++i) video.add(frame_of(i));
    EXPECT_EQ(video.frame_count(), frames);
    video.close();
}

int distance(Rgb a, Rgb b) {
    return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

TEST(Video, DecodesToTheSamePictures) {
    const TemporaryFolder folder;
    VideoSettings settings;
    settings.fps = 25.0;
    write_video(folder.file("a.mp4"), 10, settings);
    const DecodedVideo video = decode_video(folder.file("a.mp4"));
    EXPECT_EQ(video.codec, "h264");
    EXPECT_EQ(video.pixel_format, "yuv420p");
    EXPECT_DOUBLE_EQ(video.fps, 25.0);
    ASSERT_EQ(video.frames.size(), 10u);
    for (int i = 0; i < 10; ++i) {
        const Image& decoded = video.frames[static_cast<std::size_t>(i)];
        const Image expected = frame_of(i);
        ASSERT_EQ(decoded.width(), kWidth);
        ASSERT_EQ(decoded.height(), kHeight);
        for (int x : {20, 140})
            EXPECT_LE(distance(decoded.at(x, 48), expected.at(x, 48)), 6)
                << "frame " << i << ", x " << x;
    }
    EXPECT_EQ(folder.file_count(), 1u) << "a temporary file was left behind";
}

TEST(Video, EvenASingleFrameIsAVideo) {
    const TemporaryFolder folder;
    write_video(folder.file("a.mp4"), 1);
    EXPECT_EQ(decode_video(folder.file("a.mp4")).frames.size(), 1u);
}

TEST(Video, BrowsersCanPlayItWhileItLoads) {
    const TemporaryFolder folder;
    write_video(folder.file("a.mp4"), 5);
    const std::string bytes = content_of(folder.file("a.mp4"));
    EXPECT_LT(bytes.find("moov"), bytes.find("mdat")) << "the index is not in front of the data";
}

TEST(Video, EqualPicturesGiveEqualBytes) {
    const TemporaryFolder folder;
    write_video(folder.file("a.mp4"), 7);
    write_video(folder.file("b.mp4"), 7);
    EXPECT_EQ(content_of(folder.file("a.mp4")), content_of(folder.file("b.mp4")));
}

TEST(Video, NothingAppearsBeforeClose) {
    const TemporaryFolder folder;
    folder.write("a.mp4", "old");
    {
        VideoWriter video(folder.file("a.mp4"), kWidth, kHeight);
        video.add(frame_of(0));
    }
    EXPECT_EQ(content_of(folder.file("a.mp4")), "old");
    EXPECT_EQ(folder.file_count(), 1u) << "a temporary file was left behind";
}

TEST(Video, UnusableInputIsRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.mp4");
    EXPECT_THROW(VideoWriter(path, 161, 96), ArgumentError);
    EXPECT_THROW(VideoWriter(path, 160, 0), ArgumentError);
    VideoSettings settings;
    settings.fps = 0.0;
    EXPECT_THROW(VideoWriter(path, 160, 96, settings), ArgumentError);
    settings = VideoSettings();
    settings.quality = 99;
    EXPECT_THROW(VideoWriter(path, 160, 96, settings), ArgumentError);

    VideoWriter video(path, kWidth, kHeight);
    EXPECT_THROW(video.close(), ArgumentError) << "no picture";
    EXPECT_THROW(video.add(Image(8, 8)), ArgumentError);
    video.add(frame_of(0));
    video.close();
    EXPECT_THROW(video.add(frame_of(1)), ArgumentError);
    EXPECT_NO_THROW(video.close());
}

TEST(Video, PathWithoutFolderIsRefusedByName) {
    const std::string path = "/nonexistent_folder/a.mp4";
    const std::string message = message_of<LoadError>([&] { VideoWriter(path, 160, 96); });
    EXPECT_NE(message.find(path), std::string::npos) << message;
    EXPECT_NE(message.find("Remedy"), std::string::npos) << message;
}

}  // namespace
}  // namespace cloth::test
