#include "app/video_reader.h"

#include "core/check.h"
#include "media/padded_rows.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

namespace fantascope {
namespace {

Rgba16Image pictureOf(const AVFrame& frame) {
    Rgba16Image picture(frame.width, frame.height);
    SwsContext* const convert =
        sws_getContext(frame.width, frame.height, static_cast<AVPixelFormat>(frame.format), frame.width, frame.height,
                       AV_PIX_FMT_RGBA64LE, SWS_POINT | SWS_ACCURATE_RND, nullptr, nullptr, nullptr);
    FANTASCOPE_CHECK(convert != nullptr, "the frame's format is known");
    const int* const matrix = sws_getCoefficients(frame.colorspace == AVCOL_SPC_BT709 ? SWS_CS_ITU709 : SWS_CS_DEFAULT);
    sws_setColorspaceDetails(convert, matrix, frame.color_range == AVCOL_RANGE_JPEG ? 1 : 0, matrix, 1, 0, 1 << 16, 1 << 16);
    PaddedRows<Rgba16>().fill(picture, [&](std::uint8_t* rows, int stride) {
        sws_scale(convert, frame.data, frame.linesize, 0, frame.height, &rows, &stride);
    });
    sws_freeContext(convert);
    return picture;
}

}  // namespace

Video readVideo(const std::filesystem::path& file) {
    Video video;
    AVFormatContext* container = nullptr;
    FANTASCOPE_CHECK(avformat_open_input(&container, file.c_str(), nullptr, nullptr) == 0, file.string());
    FANTASCOPE_CHECK(avformat_find_stream_info(container, nullptr) >= 0, file.string());
    const AVStream& stream = *container->streams[0];
    video.seconds = static_cast<double>(container->duration) / AV_TIME_BASE;
    video.framesPerSecond = av_q2d(stream.avg_frame_rate);
    const AVCodec* const codec = avcodec_find_decoder(stream.codecpar->codec_id);
    video.codec = codec->name;
    AVCodecContext* decoder = avcodec_alloc_context3(codec);
    avcodec_parameters_to_context(decoder, stream.codecpar);
    FANTASCOPE_CHECK(avcodec_open2(decoder, codec, nullptr) == 0, file.string());
    AVPacket* packet = av_packet_alloc();
    AVFrame* frame = av_frame_alloc();
    const auto take = [&] {
        while (avcodec_receive_frame(decoder, frame) == 0) {
            video.times.push_back(static_cast<double>(frame->best_effort_timestamp) * av_q2d(stream.time_base));
            video.frames.push_back(pictureOf(*frame));
        }
    };
    while (av_read_frame(container, packet) == 0) {
        FANTASCOPE_CHECK(avcodec_send_packet(decoder, packet) == 0, file.string());
        av_packet_unref(packet);
        take();
    }
    avcodec_send_packet(decoder, nullptr);
    take();
    av_frame_free(&frame);
    av_packet_free(&packet);
    avcodec_free_context(&decoder);
    avformat_close_input(&container);
    return video;
}

}  // namespace fantascope
