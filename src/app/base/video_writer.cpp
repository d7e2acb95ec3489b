#include "app/base/video_writer.h"

#include "core/check.h"
#include "core/file.h"
#include "media/padded_rows.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

namespace fantascope::app {

namespace fs = std::filesystem;

namespace {

static_assert(std::endian::native == std::endian::little, "16-bit pictures are handed over as they lie in memory");
constexpr AVPixelFormat kFrom8Bit = AV_PIX_FMT_RGBA, kFrom16Bit = AV_PIX_FMT_RGBA64LE;

struct Coding {
    const char *encoder, *container;
    AVPixelFormat format;
    std::vector<std::pair<const char*, const char*>> options;  // the encoder's own
};

Coding codingOf(VideoKind kind) {
    switch (kind) {
        case VideoKind::Recording:  // the fastest preset that still keeps fine light on black
            return {"libx264", "mp4", AV_PIX_FMT_YUV420P, {{"preset", "ultrafast"}, {"crf", "20"}}};
        case VideoKind::Film:
            return {"libx264", "mp4", AV_PIX_FMT_YUV420P, {{"preset", "fast"}, {"crf", "16"}}};
        case VideoKind::ProRes4444:
            return {"prores_ks", "mov", AV_PIX_FMT_YUVA444P10LE, {{"profile", "4444"}, {"alpha_bits", "16"}, {"vendor", "apl0"}}};
        case VideoKind::Lossless:
            return {"ffv1", "matroska", kFrom16Bit, {{"level", "3"}, {"slicecrc", "1"}}};
    }
    return {};
}

std::string reason(int code) {
    char text[AV_ERROR_MAX_STRING_SIZE] = {};
    av_strerror(code, text, sizeof text);
    return text;
}

// libav writes through these functions, so that it can write to a file without a name. `file`: its
// descriptor.
int writeTo(void* file, std::uint8_t* bytes, int size) {
    for (int left = size; left > 0;) {
        const ssize_t written = ::write(*static_cast<int*>(file), bytes + (size - left), static_cast<std::size_t>(left));
        if (written < 0 && errno != EINTR) return AVERROR(errno);
        left -= static_cast<int>(std::max<ssize_t>(written, 0));
    }
    return size;
}
std::int64_t seekIn(void* file, std::int64_t offset, int whence) {
    if (whence == AVSEEK_SIZE) return AVERROR(ENOSYS);
    const off_t place = ::lseek(*static_cast<int*>(file), offset, whence & ~AVSEEK_FORCE);
    return place < 0 ? AVERROR(errno) : place;
}

}  // namespace

struct VideoWriter::Impl {
    fs::path file;
    std::optional<NewFile> target;
    int descriptor = -1;  // the target's
    int ticks = 1;        // a frame
    glm::ivec2 pictureSize{0};
    AVFormatContext* container = nullptr;
    AVCodecContext* encoder = nullptr;
    AVStream* stream = nullptr;
    AVFrame* frame = nullptr;
    AVPacket* packet = nullptr;
    SwsContext* fromPicture = nullptr;
    AVPixelFormat pictureFormat = AV_PIX_FMT_NONE;  // the input of fromPicture
    PaddedRows<Rgba8> rows;                         // for libswscale
    PaddedRows<Rgba16> wideRows;

    ~Impl() {
        sws_freeContext(fromPicture);
        av_packet_free(&packet);
        av_frame_free(&frame);
        avcodec_free_context(&encoder);
        if (container == nullptr) return;
        if (container->pb != nullptr) av_freep(&container->pb->buffer);
        avio_context_free(&container->pb);
        avformat_free_context(container);
    }

    Error error(std::string_view what, int code) const {
        return Error(fmt::format("{}: {}: {}", file.string(), what, reason(code)));
    }

    // Hands the encoder a picture, or nullptr at the end, and writes what it gives back.
    Result<void> encode(const AVFrame* picture) {
        int code = avcodec_send_frame(encoder, picture);
        if (code < 0) return error("encoding failed", code);
        while ((code = avcodec_receive_packet(encoder, packet)) >= 0) {
            // A frame is shown until the next one. Nothing follows the last frame: without a
            // duration of its own it would be shown for no time, and players drop it.
            packet->duration = ticks;
            av_packet_rescale_ts(packet, encoder->time_base, stream->time_base);
            packet->stream_index = stream->index;
            if (code = av_interleaved_write_frame(container, packet); code < 0) return error("cannot be written", code);
        }
        if (code != AVERROR(EAGAIN) && code != AVERROR_EOF) return error("encoding failed", code);
        return {};
    }

    bool holdsRgb() const { return (av_pix_fmt_desc_get(encoder->pix_fmt)->flags & AV_PIX_FMT_FLAG_RGB) != 0; }

    void convertFrom(AVPixelFormat format) {
        if (format == pictureFormat) return;
        sws_freeContext(fromPicture);
        pictureFormat = format;
        fromPicture = sws_getContext(encoder->width, encoder->height, format, encoder->width, encoder->height, encoder->pix_fmt,
                                     SWS_BILINEAR | SWS_ACCURATE_RND, nullptr, nullptr, nullptr);
        const int* const bt709 = sws_getCoefficients(SWS_CS_ITU709);
        constexpr int kFull = 1, kOne = 1 << 16;
        sws_setColorspaceDetails(fromPicture, bt709, kFull, bt709, holdsRgb() ? kFull : 0, 0, kOne, kOne);
    }

    template <class Pixel>
    Result<void> write(const Image<Pixel>& picture, PaddedRows<Pixel>& padded, AVPixelFormat format, std::int64_t number) {
        if (const int code = av_frame_make_writable(frame); code < 0) return error("no memory for a frame", code);
        convertFrom(format);
        padded.lend(picture, [&](const std::uint8_t* pixels, int stride) {
            sws_scale(fromPicture, &pixels, &stride, 0, encoder->height, frame->data, frame->linesize);
        });
        frame->pts = number;
        return encode(frame);
    }
};

VideoWriter::VideoWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoWriter::~VideoWriter() = default;

Result<std::unique_ptr<VideoWriter>> VideoWriter::open(const fs::path& file, glm::ivec2 size, double frameRate, VideoKind kind,
                                                       int ticks) {
    FANTASCOPE_CHECK(size.x >= 2 && size.y >= 2 && frameRate >= 1 && frameRate <= 1000, "a video has a size and a frame rate");
    av_log_set_level(AV_LOG_ERROR);
    auto impl = std::make_unique<Impl>();
    impl->file = file;
    impl->pictureSize = size;
    impl->ticks = ticks;

    const Coding coding = codingOf(kind);
    const AVCodec* codec = avcodec_find_encoder_by_name(coding.encoder);
    if (codec == nullptr)
        return Error(
            fmt::format("{}: no encoder {} here; install Debian's libavcodec, which has it", file.string(), coding.encoder));
    if (const int code = avformat_alloc_output_context2(&impl->container, nullptr, coding.container, nullptr); code < 0)
        return impl->error("no such container", code);
    impl->container->flags |= AVFMT_FLAG_BITEXACT;
    impl->encoder = avcodec_alloc_context3(codec);
    AVCodecContext& encoder = *impl->encoder;
    const bool halvesColours = av_pix_fmt_desc_get(coding.format)->log2_chroma_w > 0;
    encoder.width = halvesColours ? size.x & ~1 : size.x;
    encoder.height = halvesColours ? size.y & ~1 : size.y;
    encoder.pix_fmt = coding.format;
    encoder.color_primaries = AVCOL_PRI_BT709;
    encoder.color_trc = AVCOL_TRC_IEC61966_2_1;
    encoder.colorspace = impl->holdsRgb() ? AVCOL_SPC_RGB : AVCOL_SPC_BT709;
    encoder.color_range = impl->holdsRgb() ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
    encoder.time_base = av_d2q(1 / (frameRate * ticks), 1'000'000);
    encoder.framerate = av_mul_q(av_inv_q(encoder.time_base), {1, ticks});
    encoder.thread_count = 1;
    encoder.flags |= AV_CODEC_FLAG_BITEXACT;
    if (impl->container->oformat->flags & AVFMT_GLOBALHEADER) encoder.flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    for (const auto& [name, value] : coding.options) av_opt_set(encoder.priv_data, name, value, 0);
    if (const int code = avcodec_open2(&encoder, codec, nullptr); code < 0)
        return impl->error("the encoder refuses this size or rate", code);

    impl->stream = avformat_new_stream(impl->container, nullptr);
    impl->stream->time_base = encoder.time_base;
    impl->stream->avg_frame_rate = encoder.framerate;
    avcodec_parameters_from_context(impl->stream->codecpar, &encoder);
    impl->target.emplace(TRY(NewFile::open(file)));
    impl->descriptor = impl->target->descriptor();
    constexpr int kBuffer = 1 << 16, kWrites = 1;
    impl->container->pb = avio_alloc_context(static_cast<unsigned char*>(av_malloc(kBuffer)), kBuffer, kWrites, &impl->descriptor,
                                             nullptr, writeTo, seekIn);
    if (const int code = avformat_write_header(impl->container, nullptr); code < 0) return impl->error("cannot be written", code);

    impl->packet = av_packet_alloc();
    impl->frame = av_frame_alloc();
    impl->frame->format = encoder.pix_fmt;
    impl->frame->width = encoder.width;
    impl->frame->height = encoder.height;
    // Some encoders read these from the frame.
    impl->frame->color_primaries = encoder.color_primaries;
    impl->frame->color_trc = encoder.color_trc;
    impl->frame->colorspace = encoder.colorspace;
    impl->frame->color_range = encoder.color_range;
    if (const int code = av_frame_get_buffer(impl->frame, 0); code < 0) return impl->error("no memory for a frame", code);
    return std::unique_ptr<VideoWriter>(new VideoWriter(std::move(impl)));
}

Result<void> VideoWriter::write(const RgbaImage& picture, std::int64_t number) {
    FANTASCOPE_CHECK(glm::ivec2(picture.width(), picture.height()) == impl_->pictureSize, "a picture of another size");
    if (impl_->encoder->pix_fmt == kFrom16Bit) {  // libswscale would make 254 / 255 of white
        Rgba16Image wide(picture.width(), picture.height());
        const auto word = [](std::uint8_t byte) { return static_cast<std::uint16_t>(257 * byte); };
        std::transform(picture.pixels().begin(), picture.pixels().end(), wide.pixels().begin(), [&](Rgba8 pixel) {
            return Rgba16{word(pixel.r), word(pixel.g), word(pixel.b), word(pixel.a)};
        });
        return write(wide, number);
    }
    return impl_->write(picture, impl_->rows, kFrom8Bit, number);
}

Result<void> VideoWriter::write(const Rgba16Image& picture, std::int64_t number) {
    FANTASCOPE_CHECK(glm::ivec2(picture.width(), picture.height()) == impl_->pictureSize, "a picture of another size");
    return impl_->write(picture, impl_->wideRows, kFrom16Bit, number);
}

Result<void> VideoWriter::finish() {
    TRY(impl_->encode(nullptr));
    if (const int code = av_write_trailer(impl_->container); code < 0) return impl_->error("cannot be ended", code);
    avio_flush(impl_->container->pb);
    if (const int code = impl_->container->pb->error; code < 0) return impl_->error("cannot be written", code);
    return impl_->target->finish();
}

}  // namespace fantascope::app
