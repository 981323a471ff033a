#include "render/video.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/imgutils.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <array>
#include <cmath>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "render/replaced_file.h"

namespace cloth {

namespace {

constexpr int kThreads = 2;  // a fixed number: the encoder's decisions depend on it

std::string text_of(int error) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    return av_make_error_string(text.data(), text.size(), error);
}

/// Keeps ffmpeg's progress messages off the terminal; warnings and errors stay.
class QuietFfmpeg {
 public:
    QuietFfmpeg() : m_level(av_log_get_level()) {
        av_log_set_level(std::min(m_level, AV_LOG_WARNING));
    }
    ~QuietFfmpeg() { av_log_set_level(m_level); }
    QuietFfmpeg(const QuietFfmpeg&) = delete;
    QuietFfmpeg& operator=(const QuietFfmpeg&) = delete;

 private:
    int m_level;
};

void check_settings(int width, int height, const VideoSettings& settings) {
    const auto bad = [](int size) { return size < 16 || size > 8192 || size % 2 != 0; };
    if (bad(width) || bad(height))
        throw ArgumentError(
            "VideoWriter",
            "size " + std::to_string(width) + " x " + std::to_string(height) + " cannot be encoded",
            "choose even sizes of 16 to 8192 pixels; montage() makes even ones");
    check_range("VideoSettings.fps", settings.fps, 1.0, 240.0);
    check_range("VideoSettings.quality", settings.quality, 0, 51);
    check_range("VideoSettings.key_frame_interval", settings.key_frame_interval, 1, 600);
}

}  // namespace

class VideoWriter::Implementation {
 public:
    Implementation(const std::string& path, int width, int height, const VideoSettings& settings);
    ~Implementation() { release(); }
    Implementation(const Implementation&) = delete;
    Implementation& operator=(const Implementation&) = delete;

    void add(const Image& image);
    void close();
    int frame_count() const { return m_frame_count; }

 private:
    void open(int width, int height, const VideoSettings& settings);
    void open_encoder(int width, int height, const VideoSettings& settings);
    void open_file();
    void open_converter();
    void write_packets();
    void release();
    void require(int result, const std::string& place) const;

    ReplacedFile m_file;
    AVFormatContext* m_format = nullptr;
    AVCodecContext* m_encoder = nullptr;
    AVStream* m_stream = nullptr;
    SwsContext* m_converter = nullptr;
    AVFrame* m_frame = nullptr;
    AVPacket* m_packet = nullptr;
    int m_frame_count = 0;
    bool m_closed = false;
};

VideoWriter::Implementation::Implementation(const std::string& path, int width, int height,
                                            const VideoSettings& settings)
    : m_file(path) {
    check_settings(width, height, settings);
    const QuietFfmpeg quiet;
    try {
        open(width, height, settings);
    } catch (...) {
        release();
        throw;
    }
}

void VideoWriter::Implementation::require(int result, const std::string& place) const {
    if (result >= 0) return;
    throw LoadError(m_file.path(), place, "the video cannot be written (" + text_of(result) + ")",
                    "check that the folder exists, may be written to and has space left");
}

void VideoWriter::Implementation::open(int width, int height, const VideoSettings& settings) {
    require(avformat_alloc_output_context2(&m_format, nullptr, "mp4", nullptr), "MP4 container");
    open_encoder(width, height, settings);
    open_file();
    open_converter();
}

void VideoWriter::Implementation::open_encoder(int width, int height,
                                               const VideoSettings& settings) {
    const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
    if (!codec)
        throw LoadError(m_file.path(), "encoder", "this ffmpeg has no libx264 encoder for H.264",
                        "install an ffmpeg built with --enable-libx264, as Debian's libavcodec59");
    m_encoder = avcodec_alloc_context3(codec);
    m_encoder->width = width;
    m_encoder->height = height;
    m_encoder->pix_fmt = AV_PIX_FMT_YUV420P;
    m_encoder->framerate = av_d2q(settings.fps, 1000000);
    m_encoder->time_base = av_inv_q(m_encoder->framerate);
    m_encoder->gop_size = settings.key_frame_interval;
    m_encoder->color_range = AVCOL_RANGE_MPEG;
    m_encoder->colorspace = AVCOL_SPC_BT709;
    m_encoder->color_primaries = AVCOL_PRI_BT709;
    m_encoder->color_trc = AVCOL_TRC_BT709;
    m_encoder->thread_count = kThreads;
    // The container keeps the stream's headers; no time stamps or versions in the file.
    m_encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_BITEXACT;
    av_opt_set(m_encoder->priv_data, "preset", "medium", 0);
    av_opt_set_double(m_encoder->priv_data, "crf", settings.quality, 0);
    require(avcodec_open2(m_encoder, codec, nullptr), "encoder libx264");
}

void VideoWriter::Implementation::open_file() {
    m_stream = avformat_new_stream(m_format, nullptr);
    m_stream->time_base = m_encoder->time_base;
    m_stream->avg_frame_rate = m_encoder->framerate;
    require(avcodec_parameters_from_context(m_stream->codecpar, m_encoder), "stream");
    m_format->flags |= AVFMT_FLAG_BITEXACT;
    // "faststart" opens the file once more, by this name.
    m_format->url = av_strdup(m_file.temporary_path().c_str());
    require(avio_open(&m_format->pb, m_file.temporary_path().c_str(), AVIO_FLAG_WRITE), "");
    AVDictionary* options = nullptr;
    av_dict_set(&options, "movflags", "+faststart", 0);
    const int result = avformat_write_header(m_format, &options);
    av_dict_free(&options);
    require(result, "header");
}

void VideoWriter::Implementation::open_converter() {
    m_packet = av_packet_alloc();
    m_frame = av_frame_alloc();
    m_frame->format = m_encoder->pix_fmt;
    m_frame->width = m_encoder->width;
    m_frame->height = m_encoder->height;
    require(av_frame_get_buffer(m_frame, 0), "picture buffer");
    m_converter =
        sws_getContext(m_frame->width, m_frame->height, AV_PIX_FMT_RGB24, m_frame->width,
                       m_frame->height, AV_PIX_FMT_YUV420P,
                       SWS_BICUBIC | SWS_ACCURATE_RND | SWS_BITEXACT, nullptr, nullptr, nullptr);
    if (!m_converter) require(AVERROR(ENOMEM), "colour conversion");
    const int* matrix = sws_getCoefficients(SWS_CS_ITU709);
    sws_setColorspaceDetails(m_converter, matrix, 1, matrix, 0, 0, 1 << 16, 1 << 16);
}

void VideoWriter::Implementation::add(const Image& image) {
    if (m_closed)
        throw ArgumentError("VideoWriter::add", "the video is closed", "add before close()");
    if (image.width() != m_frame->width || image.height() != m_frame->height)
        throw ArgumentError("VideoWriter::add",
                            "the picture has " + std::to_string(image.width()) + " x " +
                                std::to_string(image.height()) + " pixels, the video " +
                                std::to_string(m_frame->width) + " x " +
                                std::to_string(m_frame->height),
                            "render every picture in the size of the video");
    require(av_frame_make_writable(m_frame), "picture buffer");
    const std::uint8_t* source[] = {image.bytes()};
    const int stride[] = {3 * image.width()};
    sws_scale(m_converter, source, stride, 0, image.height(), m_frame->data, m_frame->linesize);
    m_frame->pts = m_frame_count;
    require(avcodec_send_frame(m_encoder, m_frame), "picture " + std::to_string(m_frame_count));
    ++m_frame_count;
    write_packets();
}

void VideoWriter::Implementation::write_packets() {
    for (;;) {
        const int result = avcodec_receive_packet(m_encoder, m_packet);
        if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return;
        require(result, "encoder libx264");
        m_packet->duration = 1;
        av_packet_rescale_ts(m_packet, m_encoder->time_base, m_stream->time_base);
        m_packet->stream_index = m_stream->index;
        require(av_interleaved_write_frame(m_format, m_packet), "stream");
    }
}

void VideoWriter::Implementation::close() {
    if (m_closed) return;
    if (m_frame_count == 0)
        throw ArgumentError("VideoWriter::close", "no picture was added to " + m_file.path(),
                            "add at least one");
    const QuietFfmpeg quiet;
    require(avcodec_send_frame(m_encoder, nullptr), "encoder libx264");
    write_packets();
    require(av_write_trailer(m_format), "trailer");
    require(avio_closep(&m_format->pb), "");
    m_file.commit();
    m_closed = true;
}

void VideoWriter::Implementation::release() {
    const QuietFfmpeg quiet;
    sws_freeContext(m_converter);
    av_frame_free(&m_frame);
    av_packet_free(&m_packet);
    avcodec_free_context(&m_encoder);
    if (m_format && m_format->pb) avio_closep(&m_format->pb);
    avformat_free_context(m_format);
    m_format = nullptr;
    m_converter = nullptr;
}

VideoWriter::VideoWriter(const std::string& path, int width, int height,
                         const VideoSettings& settings)
    : m_implementation(std::make_unique<Implementation>(path, width, height, settings)) {
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::add(const Image& image) {
    m_implementation->add(image);
}
void VideoWriter::close() {
    m_implementation->close();
}
int VideoWriter::frame_count() const {
    return m_implementation->frame_count();
}

}  // namespace cloth
