#include "test_video.h"

#include "core/check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <numeric>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
}

namespace fantascope {
namespace {

constexpr int kBlocks = 4;  // a side

void must(int code, const char* what) { FANTASCOPE_CHECK(code >= 0, what); }

// Luma and colour differences, 0..1 and -0.5..0.5 (ITU-R BT.601, BT.709).
struct Yuv {
    double y, u, v;
};
Yuv yuvOf(Rgba8 pixel, const std::string& matrix) {
    const bool old = matrix == "smpte170m" || matrix == "bt470bg";
    const double kr = old ? 0.299 : 0.2126, kb = old ? 0.114 : 0.0722;
    const double r = pixel.r / 255.0, g = pixel.g / 255.0, b = pixel.b / 255.0, y = kr * r + (1 - kr - kb) * g + kb * b;
    return {y, (b - y) / (2 * (1 - kb)), (r - y) / (2 * (1 - kr))};
}

// Puts the picture into the frame, plane by plane, the mean over the pixels that a value stands
// for.
void fill(AVFrame& frame, const RgbaImage& picture, const VideoCoding& coding) {
    if (picture.empty()) {
        std::memset(frame.data[0], 0, static_cast<std::size_t>(frame.linesize[0]) * static_cast<std::size_t>(frame.height));
        return;
    }
    const AVPixFmtDescriptor& format = *av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
    const bool full = coding.range == "pc", rgb = (format.flags & AV_PIX_FMT_FLAG_RGB) != 0;
    const double most = (1 << format.comp[0].depth) - 1, unit = (1 << (format.comp[0].depth - 8));
    for (int component = 0; component < format.nb_components; ++component) {
        const AVComponentDescriptor& place = format.comp[component];
        const bool colour = !rgb && (component == 1 || component == 2), alpha = component == 3;
        const int wide = colour ? 1 << format.log2_chroma_w : 1, high = colour ? 1 << format.log2_chroma_h : 1;
        for (int y = 0; y < (picture.height() + high - 1) / high; ++y)
            for (int x = 0; x < (picture.width() + wide - 1) / wide; ++x) {
                double sum = 0;
                for (int i = 0; i < wide * high; ++i) {
                    // An odd last column or row counts twice.
                    const Rgba8 pixel = picture.at(std::min(x * wide + i % wide, picture.width() - 1),
                                                   std::min(y * high + i / wide, picture.height() - 1));
                    const Yuv yuv = yuvOf(pixel, coding.matrix);
                    const double values[] = {rgb ? pixel.r / 255.0 : yuv.y, rgb ? pixel.g / 255.0 : yuv.u,
                                             rgb ? pixel.b / 255.0 : yuv.v, pixel.a / 255.0};
                    sum += values[component];
                }
                const double mean = sum / (wide * high);
                const double value = rgb || alpha ? mean * most
                                     : full       ? mean * most + (colour ? (most + 1) / 2 : 0)
                                     : colour     ? (128 + 224 * mean) * unit
                                                  : (16 + 219 * mean) * unit;
                const auto stored = static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0, most)));
                std::uint8_t* const at =
                    frame.data[place.plane] + y * frame.linesize[place.plane] + x * place.step + place.offset;
                at[0] = static_cast<std::uint8_t>(stored);
                if (place.depth > 8) at[1] = static_cast<std::uint8_t>(stored >> 8);
            }
    }
}

}  // namespace

void writeVideo(const std::filesystem::path& file, const VideoCoding& coding, const std::vector<std::int64_t>& begins,
                const std::function<RgbaImage(int)>& pictureOf) {
    av_log_set_level(AV_LOG_ERROR);
    AVFormatContext* container = nullptr;
    must(avformat_alloc_output_context2(&container, nullptr, nullptr, file.c_str()), "a container by this ending");
    const AVCodec* const codec = avcodec_find_encoder_by_name(coding.encoder.c_str());
    FANTASCOPE_CHECK(codec != nullptr, coding.encoder);
    AVCodecContext* encoder = avcodec_alloc_context3(codec);
    encoder->width = coding.size.x;
    encoder->height = coding.size.y;
    encoder->pix_fmt = av_get_pix_fmt(coding.pixels.c_str());
    encoder->colorspace = static_cast<AVColorSpace>(std::max(0, av_color_space_from_name(coding.matrix.c_str())));
    if (coding.matrix == "unknown") encoder->colorspace = AVCOL_SPC_UNSPECIFIED;
    encoder->color_range = static_cast<AVColorRange>(av_color_range_from_name(coding.range.c_str()));
    encoder->framerate = {coding.rate, coding.rateDivisor};
    encoder->time_base = {coding.rateDivisor, coding.rate};
    encoder->gop_size = coding.keyEvery;
    encoder->max_b_frames = coding.bFrames;
    encoder->thread_count = 1;
    encoder->strict_std_compliance = FF_COMPLIANCE_UNOFFICIAL;
    if ((container->oformat->flags & AVFMT_GLOBALHEADER) != 0) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    if (coding.encoder == "libx264") {
        av_opt_set(encoder->priv_data, "preset", "fast", 0);
        av_opt_set(encoder->priv_data, "crf", "12", 0);
        av_opt_set(encoder->priv_data, "x264-params",
                   coding.openGroups ? "open-gop=1:scenecut=0:b-adapt=0" : "scenecut=0:b-adapt=0", 0);
    }
    must(avcodec_open2(encoder, codec, nullptr), "the encoder takes this coding");
    AVStream* const stream = avformat_new_stream(container, nullptr);
    stream->time_base = encoder->time_base;
    stream->avg_frame_rate = encoder->framerate;
    must(avcodec_parameters_from_context(stream->codecpar, encoder), "parameters");
    must(avio_open(&container->pb, file.c_str(), AVIO_FLAG_WRITE), "the file can be written");
    must(avformat_write_header(container, nullptr), "a header");

    AVFrame* frame = av_frame_alloc();
    frame->format = encoder->pix_fmt;
    frame->width = coding.size.x;
    frame->height = coding.size.y;
    must(av_frame_get_buffer(frame, 0), "memory");
    AVPacket* packet = av_packet_alloc();
    const auto encode = [&](const AVFrame* picture) {
        must(avcodec_send_frame(encoder, picture), "a frame is encoded");
        while (avcodec_receive_packet(encoder, packet) == 0) {
            const auto here = std::ranges::find(begins, packet->pts);
            packet->duration = here + 1 < begins.end() ? here[1] - here[0] : 1;
            av_packet_rescale_ts(packet, encoder->time_base, stream->time_base);
            must(av_interleaved_write_frame(container, packet), "a packet is written");
        }
    };
    for (std::size_t i = 0; i < begins.size(); ++i) {
        must(av_frame_make_writable(frame), "memory");
        fill(*frame, pictureOf(static_cast<int>(i)), coding);
        frame->pts = begins[i];
        frame->colorspace = encoder->colorspace;
        frame->color_range = encoder->color_range;
        encode(frame);
    }
    encode(nullptr);
    must(av_write_trailer(container), "a trailer");
    av_packet_free(&packet);
    av_frame_free(&frame);
    avcodec_free_context(&encoder);
    avio_closep(&container->pb);
    avformat_free_context(container);
}

void writeVideo(const std::filesystem::path& file, const VideoCoding& coding, int frames,
                const std::function<RgbaImage(int)>& pictureOf) {
    std::vector<std::int64_t> begins(static_cast<std::size_t>(frames));
    std::iota(begins.begin(), begins.end(), 0);
    writeVideo(file, coding, begins, pictureOf);
}

RgbaImage numbered(glm::ivec2 size, int number) {
    RgbaImage picture(size.x, size.y);
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            const int bit = y * kBlocks / size.y * kBlocks + x * kBlocks / size.x;
            const std::uint8_t grey = (number >> bit & 1) != 0 ? 220 : 30;
            picture.at(x, y) = {grey, grey, grey, 255};
        }
    return picture;
}

int numberOn(const RgbaImage& picture) {
    int number = 0;
    for (int bit = 0; bit < kBlocks * kBlocks; ++bit) {
        const int x = (2 * (bit % kBlocks) + 1) * picture.width() / (2 * kBlocks);
        const int y = (2 * (bit / kBlocks) + 1) * picture.height() / (2 * kBlocks);
        if (picture.at(x, y).g >= 128) number |= 1 << bit;
    }
    return number;
}

RgbaImage noisy(glm::ivec2 size, int number) {
    RgbaImage picture = numbered(size, number);
    unsigned state = static_cast<unsigned>(number) * 2654435761u + 1;
    for (Rgba8& pixel : picture.pixels()) {
        state = state * 1664525u + 1013904223u;
        const auto off = static_cast<std::uint8_t>(state >> 28);
        pixel = {static_cast<std::uint8_t>(pixel.r + off), static_cast<std::uint8_t>(pixel.g + off),
                 static_cast<std::uint8_t>(pixel.b + off), 255};
    }
    return picture;
}

void damage(const std::filesystem::path& file, double from, double to) {
    const auto size = static_cast<double>(std::filesystem::file_size(file));
    const auto begin = static_cast<std::size_t>(from * size), end = static_cast<std::size_t>(to * size);
    std::fstream bytes(file, std::ios::binary | std::ios::in | std::ios::out);
    bytes.seekp(static_cast<std::streamoff>(begin));
    for (std::size_t i = begin; i < end; ++i) bytes.put(static_cast<char>(i * 37 % 251));
    FANTASCOPE_CHECK(bytes.flush().good(), "the file can be written");
}

}  // namespace fantascope
