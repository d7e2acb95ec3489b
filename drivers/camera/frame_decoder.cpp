#include "drivers/camera/frame_decoder.h"

#include "core/check.h"
#include "media/padded_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

namespace fantascope::drivers {
namespace {

struct CodecDeleter {
    void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
};
struct PacketDeleter {
    void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
struct FrameDeleter {
    void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
struct ScalerDeleter {
    void operator()(SwsContext* context) const { sws_freeContext(context); }
};

// libav's name of a format. Mjpg varies from frame to frame, and Grey is converted here.
AVPixelFormat pixelsOf(FrameCoding coding) {
    switch (coding) {
        case FrameCoding::Yuyv:
            return AV_PIX_FMT_YUYV422;
        case FrameCoding::Nv12:
            return AV_PIX_FMT_NV12;
        case FrameCoding::Uyvy:
            return AV_PIX_FMT_UYVY422;
        case FrameCoding::Rgb24:
            return AV_PIX_FMT_RGB24;
        case FrameCoding::Mjpg:
        case FrameCoding::Grey:
            break;
    }
    return AV_PIX_FMT_NONE;
}

// libav's names of JPEG formats include the range, which is set separately here.
AVPixelFormat withoutRange(AVPixelFormat pixels) {
    switch (pixels) {
        case AV_PIX_FMT_YUVJ420P:
            return AV_PIX_FMT_YUV420P;
        case AV_PIX_FMT_YUVJ422P:
            return AV_PIX_FMT_YUV422P;
        case AV_PIX_FMT_YUVJ444P:
            return AV_PIX_FMT_YUV444P;
        case AV_PIX_FMT_YUVJ440P:
            return AV_PIX_FMT_YUV440P;
        default:
            return pixels;
    }
}

int matrixOf(LumaWeights weights) {
    switch (weights) {
        case LumaWeights::Rec709:
            return SWS_CS_ITU709;
        case LumaWeights::Rec2020:
            return SWS_CS_BT2020;
        case LumaWeights::Rec601:
            break;
    }
    return SWS_CS_ITU601;
}

std::size_t bytesOf(const FrameFormat& format) {
    const auto rows =
        static_cast<std::size_t>(format.coding == FrameCoding::Nv12 ? format.size.y + format.size.y / 2 : format.size.y);
    // The last row's padding may be missing.
    return (rows - 1) * static_cast<std::size_t>(format.stride) +
           static_cast<std::size_t>(minStride(format.coding, format.size.x));
}

}  // namespace

int minStride(FrameCoding coding, int width) {
    switch (coding) {
        case FrameCoding::Yuyv:
        case FrameCoding::Uyvy:
            return 2 * width;
        case FrameCoding::Rgb24:
            return 3 * width;
        case FrameCoding::Nv12:
        case FrameCoding::Grey:
            return width;
        case FrameCoding::Mjpg:
            break;
    }
    return 0;
}

struct FrameDecoder::Impl {
    FrameFormat format;
    std::array<std::uint8_t, 256> greys{};
    std::unique_ptr<SwsContext, ScalerDeleter> toRgba;
    AVPixelFormat from = AV_PIX_FMT_NONE;  // the input of toRgba
    PaddedRows<Rgba8> rows;                // for libswscale
    std::unique_ptr<AVCodecContext, CodecDeleter> jpeg;
    std::unique_ptr<AVPacket, PacketDeleter> packet;
    std::unique_ptr<AVFrame, FrameDeleter> decoded;

    Result<void> convert(AVPixelFormat pixels, const std::uint8_t* const planes[], const int strides[], RgbaImage& picture) {
        if (pixels != from) {
            from = pixels;
            toRgba.reset(sws_getContext(format.size.x, format.size.y, pixels, format.size.x, format.size.y, AV_PIX_FMT_RGBA,
                                        SWS_BILINEAR | SWS_FULL_CHR_H_INT | SWS_ACCURATE_RND, nullptr, nullptr, nullptr));
            constexpr int kOne = 1 << 16, kFull = 1;
            const int* const matrix = sws_getCoefficients(matrixOf(format.weights));
            const bool full = format.fullRange || (av_pix_fmt_desc_get(pixels)->flags & AV_PIX_FMT_FLAG_RGB) != 0;
            if (toRgba) sws_setColorspaceDetails(toRgba.get(), matrix, full ? kFull : 0, matrix, kFull, 0, kOne, kOne);
        }
        if (!toRgba) return Error(fmt::format("pixels stored as '{}', which cannot be converted", av_get_pix_fmt_name(pixels)));
        rows.fill(picture, [&](std::uint8_t* to, int stride) {
            sws_scale(toRgba.get(), planes, strides, 0, format.size.y, &to, &stride);
        });
        return {};
    }

    void convertGrey(const std::uint8_t* luma, int stride, RgbaImage& picture) const {
        for (int y = 0; y < format.size.y; ++y) {
            const std::uint8_t* const row = luma + static_cast<std::ptrdiff_t>(y) * stride;
            std::transform(row, row + format.size.x, picture.row(y).begin(), [&](std::uint8_t value) {
                const std::uint8_t grey = greys[value];
                return Rgba8{grey, grey, grey, 255};
            });
        }
    }

    Result<void> decodeJpeg(std::span<const std::uint8_t> frame, RgbaImage& picture) {
        av_packet_unref(packet.get());
        FANTASCOPE_CHECK(av_new_packet(packet.get(), static_cast<int>(frame.size())) == 0, "no memory for a frame");
        std::ranges::copy(frame, packet->data);
        av_frame_unref(decoded.get());
        if (avcodec_send_packet(jpeg.get(), packet.get()) < 0 || avcodec_receive_frame(jpeg.get(), decoded.get()) < 0 ||
            decoded->decode_error_flags != 0)
            return Error(
                fmt::format("a JPEG that is damaged, or larger than the expected {} x {} pixels", format.size.x, format.size.y));
        if (glm::ivec2(decoded->width, decoded->height) != format.size)
            return Error(fmt::format("a JPEG of {} x {} pixels instead of {} x {}", decoded->width, decoded->height,
                                     format.size.x, format.size.y));
        const auto pixels = withoutRange(static_cast<AVPixelFormat>(decoded->format));
        if (pixels != AV_PIX_FMT_GRAY8) return convert(pixels, decoded->data, decoded->linesize, picture);
        convertGrey(decoded->data[0], decoded->linesize[0], picture);
        return {};
    }
};

FrameDecoder::FrameDecoder(const FrameFormat& format) : impl_(std::make_unique<Impl>()) {
    FANTASCOPE_CHECK(format.size.x >= 2 && format.size.y >= 2 && format.stride >= minStride(format.coding, format.size.x),
                     "a frame holds its pixels");
    impl_->format = format;
    for (int value = 0; value < 256; ++value)
        impl_->greys[static_cast<std::size_t>(value)] =
            static_cast<std::uint8_t>(format.fullRange ? value : std::clamp(((value - 16) * 255 + 109) / 219, 0, 255));
    if (format.coding != FrameCoding::Mjpg) return;
    av_log_set_level(AV_LOG_FATAL);  // damage is reported once, by the driver
    const AVCodec* const codec = avcodec_find_decoder(AV_CODEC_ID_MJPEG);
    FANTASCOPE_CHECK(codec != nullptr, "libavcodec decodes JPEG");
    impl_->jpeg.reset(avcodec_alloc_context3(codec));
    impl_->jpeg->thread_count = 1;  // several threads would delay frames
    // A damaged header may state any size, so nothing larger is decoded. libav includes a row's
    // padding.
    constexpr int kAlignment = 64;
    impl_->jpeg->max_pixels = std::int64_t{format.size.x + kAlignment - 1} / kAlignment * kAlignment * format.size.y;
    impl_->jpeg->err_recognition = AV_EF_BITSTREAM | AV_EF_BUFFER | AV_EF_EXPLODE;
    FANTASCOPE_CHECK(avcodec_open2(impl_->jpeg.get(), codec, nullptr) == 0, "libavcodec decodes JPEG");
    impl_->packet.reset(av_packet_alloc());
    impl_->decoded.reset(av_frame_alloc());
}

FrameDecoder::~FrameDecoder() = default;

Result<void> FrameDecoder::decode(std::span<const std::uint8_t> frame, RgbaImage& picture) {
    const FrameFormat& format = impl_->format;
    FANTASCOPE_CHECK(glm::ivec2(picture.width(), picture.height()) == format.size, "a picture of the frame's size");
    if (format.coding == FrameCoding::Mjpg) return impl_->decodeJpeg(frame, picture);
    if (frame.size() < bytesOf(format)) return Error(fmt::format("{} bytes of {}", frame.size(), bytesOf(format)));
    if (format.coding == FrameCoding::Grey) {
        impl_->convertGrey(frame.data(), format.stride, picture);
        return {};
    }
    const std::uint8_t* const planes[4] = {
        frame.data(),
        format.coding == FrameCoding::Nv12 ? frame.data() + static_cast<std::ptrdiff_t>(format.stride) * format.size.y : nullptr};
    const int strides[4] = {format.stride, format.stride};
    return impl_->convert(pixelsOf(format.coding), planes, strides, picture);
}

}  // namespace fantascope::drivers
