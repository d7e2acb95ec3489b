#include "app/video_writer.h"

#include "core/check.h"

#include <fmt/format.h>

#include <cmath>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

namespace fantascope::app {

namespace fs = std::filesystem;

namespace {

std::string reason(int code) {
    char text[AV_ERROR_MAX_STRING_SIZE] = {};
    av_strerror(code, text, sizeof text);
    return text;
}

}  // namespace

struct VideoWriter::Impl {
    fs::path file, aside;
    glm::ivec2 pictureSize{0};
    AVFormatContext* container = nullptr;
    AVCodecContext* encoder = nullptr;
    AVStream* stream = nullptr;
    AVFrame* frame = nullptr;
    AVPacket* packet = nullptr;
    SwsContext* yuvFromRgba = nullptr;

    ~Impl() {
        sws_freeContext(yuvFromRgba);
        av_packet_free(&packet);
        av_frame_free(&frame);
        avcodec_free_context(&encoder);
        if (container != nullptr) {
            avio_closep(&container->pb);
            avformat_free_context(container);
        }
        std::error_code ignored;
        fs::remove(aside, ignored);  // renamed already if finish() succeeded
    }

    Error error(std::string_view what, int code) const {
        return Error(fmt::format("{}: {}: {}", file.string(), what, reason(code)));
    }

    // Hands the encoder a picture, or nullptr at the end, and writes what it gives back.
    Result<void> encode(const AVFrame* picture) {
        int code = avcodec_send_frame(encoder, picture);
        if (code < 0) return error("encoding failed", code);
        while ((code = avcodec_receive_packet(encoder, packet)) >= 0) {
            av_packet_rescale_ts(packet, encoder->time_base, stream->time_base);
            packet->stream_index = stream->index;
            if (code = av_interleaved_write_frame(container, packet); code < 0) return error("cannot be written", code);
        }
        if (code != AVERROR(EAGAIN) && code != AVERROR_EOF) return error("encoding failed", code);
        return {};
    }
};

VideoWriter::VideoWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoWriter::~VideoWriter() = default;

Result<std::unique_ptr<VideoWriter>> VideoWriter::open(const fs::path& file, glm::ivec2 size, double frameRate) {
    FANTASCOPE_CHECK(size.x >= 2 && size.y >= 2 && frameRate >= 1 && frameRate <= 1000, "a video has a size and a frame rate");
    av_log_set_level(AV_LOG_ERROR);
    auto impl = std::make_unique<Impl>();
    impl->file = file;
    impl->aside = file.string() + ".part";
    impl->pictureSize = size;
    std::error_code failure;
    if (file.has_parent_path()) fs::create_directories(file.parent_path(), failure);

    const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
    if (codec == nullptr)
        return Error(fmt::format("{}: no H.264 encoder here; install Debian's libavcodec with libx264", file.string()));
    if (const int code = avformat_alloc_output_context2(&impl->container, nullptr, "mp4", nullptr); code < 0)
        return impl->error("no MP4 container", code);
    impl->container->flags |= AVFMT_FLAG_BITEXACT;
    impl->encoder = avcodec_alloc_context3(codec);
    AVCodecContext& encoder = *impl->encoder;
    encoder.width = size.x & ~1;
    encoder.height = size.y & ~1;
    encoder.pix_fmt = AV_PIX_FMT_YUV420P;
    encoder.time_base = av_d2q(1 / frameRate, 1'000'000);
    encoder.framerate = av_inv_q(encoder.time_base);
    encoder.thread_count = 1;
    encoder.flags |= AV_CODEC_FLAG_BITEXACT | AV_CODEC_FLAG_GLOBAL_HEADER;
    // A rehearsal must not slow the show that it records: the quickest preset that still holds fine light on black.
    av_opt_set(encoder.priv_data, "preset", "ultrafast", 0);
    av_opt_set(encoder.priv_data, "crf", "20", 0);
    if (const int code = avcodec_open2(&encoder, codec, nullptr); code < 0)
        return impl->error("the encoder refuses this size or rate", code);

    impl->stream = avformat_new_stream(impl->container, nullptr);
    impl->stream->time_base = encoder.time_base;
    avcodec_parameters_from_context(impl->stream->codecpar, &encoder);
    if (const int code = avio_open(&impl->container->pb, impl->aside.c_str(), AVIO_FLAG_WRITE); code < 0)
        return impl->error("cannot be written", code);
    if (const int code = avformat_write_header(impl->container, nullptr); code < 0) return impl->error("cannot be written", code);

    impl->packet = av_packet_alloc();
    impl->frame = av_frame_alloc();
    impl->frame->format = encoder.pix_fmt;
    impl->frame->width = encoder.width;
    impl->frame->height = encoder.height;
    if (const int code = av_frame_get_buffer(impl->frame, 0); code < 0) return impl->error("no memory for a frame", code);
    impl->yuvFromRgba = sws_getContext(encoder.width, encoder.height, AV_PIX_FMT_RGBA, encoder.width, encoder.height,
                                       encoder.pix_fmt, SWS_BILINEAR, nullptr, nullptr, nullptr);
    return std::unique_ptr<VideoWriter>(new VideoWriter(std::move(impl)));
}

Result<void> VideoWriter::write(const RgbaImage& picture, std::int64_t number) {
    FANTASCOPE_CHECK(picture.width() == impl_->pictureSize.x && picture.height() == impl_->pictureSize.y,
                     "a picture of another size");
    if (const int code = av_frame_make_writable(impl_->frame); code < 0) return impl_->error("no memory for a frame", code);
    const auto* rows = reinterpret_cast<const std::uint8_t*>(picture.pixels().data());
    const int stride = picture.width() * 4;
    sws_scale(impl_->yuvFromRgba, &rows, &stride, 0, impl_->encoder->height, impl_->frame->data, impl_->frame->linesize);
    impl_->frame->pts = number;
    return impl_->encode(impl_->frame);
}

Result<void> VideoWriter::finish() {
    TRY(impl_->encode(nullptr));
    if (const int code = av_write_trailer(impl_->container); code < 0) return impl_->error("cannot be ended", code);
    avio_closep(&impl_->container->pb);
    std::error_code failure;
    fs::rename(impl_->aside, impl_->file, failure);
    if (failure)
        return Error(
            fmt::format("{}: cannot be renamed from {}: {}", impl_->file.string(), impl_->aside.string(), failure.message()));
    return {};
}

}  // namespace fantascope::app
