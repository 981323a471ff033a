#include "tests/render/video_decoder.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <memory>
#include <stdexcept>

namespace cloth::test {
namespace {

void require(bool ok, const std::string& what) {
    if (!ok) throw std::runtime_error("decode_video: " + what);
}

Image rgb_of(const AVFrame& frame) {
    SwsContext* converter = sws_getContext(
        frame.width, frame.height, static_cast<AVPixelFormat>(frame.format), frame.width,
        frame.height, AV_PIX_FMT_RGB24, SWS_BICUBIC | SWS_ACCURATE_RND, nullptr, nullptr, nullptr);
    require(converter != nullptr, "no colour conversion");
    const int* matrix = sws_getCoefficients(frame.colorspace);
    sws_setColorspaceDetails(converter, matrix, 0, matrix, 1, 0, 1 << 16, 1 << 16);
    Image image(frame.width, frame.height);
    std::uint8_t* target[] = {image.bytes()};
    const int stride[] = {3 * frame.width};
    sws_scale(converter, frame.data, frame.linesize, 0, frame.height, target, stride);
    sws_freeContext(converter);
    return image;
}

struct FreeFormat {
    void operator()(AVFormatContext* p) const { avformat_close_input(&p); }
};
struct FreeDecoder {
    void operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
};
struct FreeFrame {
    void operator()(AVFrame* p) const { av_frame_free(&p); }
};
struct FreePacket {
    void operator()(AVPacket* p) const { av_packet_free(&p); }
};

}  // namespace

DecodedVideo decode_video(const std::string& path) {
    AVFormatContext* opened = nullptr;
    require(avformat_open_input(&opened, path.c_str(), nullptr, nullptr) == 0, "cannot be opened");
    const std::unique_ptr<AVFormatContext, FreeFormat> format(opened);
    require(avformat_find_stream_info(format.get(), nullptr) >= 0, "no stream information");
    require(format->nb_streams == 1, "one stream expected");
    const AVStream& stream = *format->streams[0];
    const AVCodec* codec = avcodec_find_decoder(stream.codecpar->codec_id);
    require(codec != nullptr, "no decoder");
    const std::unique_ptr<AVCodecContext, FreeDecoder> decoder(avcodec_alloc_context3(codec));
    avcodec_parameters_to_context(decoder.get(), stream.codecpar);
    require(avcodec_open2(decoder.get(), codec, nullptr) == 0, "the decoder does not open");

    DecodedVideo video;
    video.fps = av_q2d(stream.avg_frame_rate);
    video.codec = avcodec_get_name(stream.codecpar->codec_id);
    video.pixel_format = av_get_pix_fmt_name(static_cast<AVPixelFormat>(stream.codecpar->format));
    const std::unique_ptr<AVPacket, FreePacket> packet(av_packet_alloc());
    const std::unique_ptr<AVFrame, FreeFrame> frame(av_frame_alloc());
    const auto receive = [&] {
        while (avcodec_receive_frame(decoder.get(), frame.get()) == 0)
            video.frames.push_back(rgb_of(*frame));
    };
    while (av_read_frame(format.get(), packet.get()) == 0) {
        require(avcodec_send_packet(decoder.get(), packet.get()) == 0, "a packet is broken");
        av_packet_unref(packet.get());
        receive();
    }
    avcodec_send_packet(decoder.get(), nullptr);
    receive();
    return video;
}

}  // namespace cloth::test
