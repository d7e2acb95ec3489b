// Frames of every coding, compared with pictures coded by this file's own arithmetic or by other
// encoders.

#include "drivers/camera/frame_decoder.h"

#include "allocations.h"
#include "core/random.h"
#include "pictures.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
}

namespace fantascope::drivers {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr glm::ivec2 kSize{96, 32};
constexpr int kBar = 8;  // px wide
constexpr std::array<Rgba8, 12> kBars{{{255, 255, 255},
                                       {255, 255, 0},
                                       {0, 255, 255},
                                       {0, 255, 0},
                                       {255, 0, 255},
                                       {255, 0, 0},
                                       {0, 0, 255},
                                       {0, 0, 0},
                                       {200, 120, 40},
                                       {30, 60, 90},
                                       {128, 128, 128},
                                       {17, 200, 130}}};

Rgba8 barAt(int x) { return kBars[static_cast<std::size_t>(x / kBar)]; }

// Rec. ITU-R BT.601, BT.709 and BT.2020, and JFIF's full range.
struct Components {
    std::uint8_t y, cb, cr;
};
Components componentsOf(Rgba8 colour, LumaWeights weights, bool fullRange) {
    const auto [red, blue] = weights == LumaWeights::Rec601   ? std::pair(.299, .114)
                             : weights == LumaWeights::Rec709 ? std::pair(.2126, .0722)
                                                              : std::pair(.2627, .0593);
    const double r = colour.r / 255., g = colour.g / 255., b = colour.b / 255.;
    const double y = red * r + (1 - red - blue) * g + blue * b, cb = (b - y) / (2 - 2 * blue), cr = (r - y) / (2 - 2 * red);
    const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0., 255.))); };
    if (fullRange) return {byte(255 * y), byte(128 + 255 * cb), byte(128 + 255 * cr)};
    return {byte(16 + 219 * y), byte(128 + 224 * cb), byte(128 + 224 * cr)};
}

// A padding value that shows if it is taken for pixels.
constexpr std::uint8_t kRubbish = 0xa5;

// `colourAt`: function of x and y, in pixels.
template <class ColourAt>
Bytes coded(const FrameFormat& format, ColourAt colourAt) {
    Bytes frame;
    const auto row = [&](int y, const auto& write) {
        const std::size_t begin = frame.size();
        for (int x = 0; x < format.size.x; ++x) write(x, componentsOf(colourAt(x, y), format.weights, format.fullRange));
        frame.resize(begin + static_cast<std::size_t>(format.stride), kRubbish);
    };
    for (int y = 0; y < format.size.y; ++y)
        row(y, [&](int x, Components c) {
            const std::uint8_t colour = x % 2 == 0 ? c.cb : c.cr;
            const Rgba8 rgb = colourAt(x, y);
            switch (format.coding) {
                case FrameCoding::Yuyv:
                    return void(frame.insert(frame.end(), {c.y, colour}));
                case FrameCoding::Uyvy:
                    return void(frame.insert(frame.end(), {colour, c.y}));
                case FrameCoding::Rgb24:
                    return void(frame.insert(frame.end(), {rgb.r, rgb.g, rgb.b}));
                case FrameCoding::Nv12:
                case FrameCoding::Grey:
                case FrameCoding::Mjpg:
                    return frame.push_back(c.y);
            }
        });
    if (format.coding == FrameCoding::Nv12)
        for (int y = 0; y < format.size.y; y += 2)
            row(y, [&](int x, Components c) { frame.push_back(x % 2 == 0 ? c.cb : c.cr); });
    frame.reserve(frame.size() + FrameDecoder::kPadding);
    return frame;
}
Bytes coded(const FrameFormat& format) {
    return coded(format, [](int x, int) { return barAt(x); });
}

// Checks the middle of each bar, free of its neighbours' colours; JPEG blocks are as wide as the
// bars.
void expectBars(const RgbaImage& picture, int tolerance) {
    for (int x = kBar / 2; x < kSize.x; x += kBar)
        for (const int y : {0, kSize.y / 2, kSize.y - 1}) {
            const Rgba8 seen = picture.at(x, y), wanted = barAt(x);
            EXPECT_NEAR(seen.r, wanted.r, tolerance) << x << ", " << y;
            EXPECT_NEAR(seen.g, wanted.g, tolerance) << x << ", " << y;
            EXPECT_NEAR(seen.b, wanted.b, tolerance) << x << ", " << y;
            EXPECT_EQ(seen.a, 255);
        }
}

class CodedFrames : public testing::TestWithParam<std::tuple<FrameCoding, LumaWeights, bool, int>> {};

FrameFormat formatOf(const CodedFrames::ParamType& kind) {
    const auto [coding, weights, fullRange, padding] = kind;
    return {coding, kSize, minStride(coding, kSize.x) + padding, fullRange, weights};
}

std::string nameOfKind(const testing::TestParamInfo<CodedFrames::ParamType>& kind) {
    const auto [coding, weights, fullRange, padding] = kind.param;
    constexpr const char* kWeights[] = {"601", "709", "2020"};
    return fmt::format("{}_{}_{}_{}", nameOf(coding), kWeights[static_cast<int>(weights)], fullRange ? "full" : "limited",
                       padding > 0 ? "padded" : "dense");
}

TEST_P(CodedFrames, show_their_colours) {
    const FrameFormat format = formatOf(GetParam());
    RgbaImage picture(kSize.x, kSize.y);
    FrameDecoder decoder(format);
    ASSERT_TRUE(decoder.decode(coded(format), picture));
    expectBars(picture, 3);
}
INSTANTIATE_TEST_SUITE_P(OfEveryKind, CodedFrames,
                         testing::Combine(testing::Values(FrameCoding::Yuyv, FrameCoding::Uyvy, FrameCoding::Nv12,
                                                          FrameCoding::Rgb24),
                                          testing::Values(LumaWeights::Rec601, LumaWeights::Rec709, LumaWeights::Rec2020),
                                          testing::Bool(), testing::Values(0, 32)),
                         nameOfKind);

TEST(GreyFrames, show_the_luma_in_either_range) {
    for (const bool fullRange : {false, true}) {
        const FrameFormat format{FrameCoding::Grey, kSize, kSize.x + 16, fullRange, LumaWeights::Rec601};
        RgbaImage picture(kSize.x, kSize.y);
        ASSERT_TRUE(FrameDecoder(format).decode(coded(format), picture));
        for (int x = 0; x < kSize.x; ++x) {
            const Rgba8 seen = picture.at(x, 5);
            EXPECT_NEAR(seen.r, componentsOf(barAt(x), LumaWeights::Rec601, true).y, 1);
            EXPECT_EQ(seen, (Rgba8{seen.r, seen.r, seen.r, 255}));
        }
    }
}

// Some drivers omit the padding of the last row; anything shorter is invalid.
TEST(CodedFrame, that_is_too_short_is_refused) {
    for (const FrameCoding coding : {FrameCoding::Yuyv, FrameCoding::Nv12, FrameCoding::Grey, FrameCoding::Rgb24}) {
        const FrameFormat format{coding, kSize, minStride(coding, kSize.x) + 32, false, LumaWeights::Rec601};
        RgbaImage picture(kSize.x, kSize.y);
        FrameDecoder decoder(format);
        Bytes frame = coded(format);
        frame.resize(frame.size() - 32);
        EXPECT_TRUE(decoder.decode(frame, picture)) << nameOf(coding);
        frame.pop_back();
        EXPECT_FALSE(decoder.decode(frame, picture)) << nameOf(coding);
        EXPECT_FALSE(decoder.decode({}, picture)) << nameOf(coding);
    }
}

FrameFormat jpegFormat(glm::ivec2 size) { return {FrameCoding::Mjpg, size, 0, true, LumaWeights::Rec601}; }

// 4:2:2, as most USB cameras code, by libav's encoder from this file's own components.
Bytes jpegByLibav() {
    const AVCodec* const codec = avcodec_find_encoder(AV_CODEC_ID_MJPEG);
    AVCodecContext* context = avcodec_alloc_context3(codec);
    context->width = kSize.x;
    context->height = kSize.y;
    context->pix_fmt = AV_PIX_FMT_YUVJ422P;
    context->time_base = {1, 25};
    context->flags |= AV_CODEC_FLAG_QSCALE;
    context->global_quality = FF_QP2LAMBDA;
    EXPECT_EQ(avcodec_open2(context, codec, nullptr), 0);
    AVFrame* frame = av_frame_alloc();
    frame->width = kSize.x;
    frame->height = kSize.y;
    frame->format = AV_PIX_FMT_YUVJ422P;
    frame->quality = FF_QP2LAMBDA;
    EXPECT_EQ(av_frame_get_buffer(frame, 0), 0);
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x) {
            const Components components = componentsOf(barAt(x), LumaWeights::Rec601, true);
            frame->data[0][y * frame->linesize[0] + x] = components.y;
            frame->data[1][y * frame->linesize[1] + x / 2] = components.cb;
            frame->data[2][y * frame->linesize[2] + x / 2] = components.cr;
        }
    AVPacket* packet = av_packet_alloc();
    EXPECT_EQ(avcodec_send_frame(context, frame), 0);
    EXPECT_EQ(avcodec_receive_packet(context, packet), 0);
    Bytes bytes(packet->data, packet->data + packet->size);
    av_packet_free(&packet);
    av_frame_free(&frame);
    avcodec_free_context(&context);
    return bytes;
}

// By libjpeg's encoder. BGR or grey.
Bytes jpegByLibjpeg(const cv::Mat& pixels) {
    Bytes bytes;
    cv::imencode(".jpg", pixels, bytes, {cv::IMWRITE_JPEG_QUALITY, 98});
    return bytes;
}

cv::Mat matOf(const RgbaImage& picture) {
    cv::Mat pixels(picture.height(), picture.width(), CV_8UC3);
    for (int y = 0; y < pixels.rows; ++y)
        for (int x = 0; x < pixels.cols; ++x) {
            const Rgba8 colour = picture.at(x, y);
            pixels.at<cv::Vec3b>(y, x) = {colour.b, colour.g, colour.r};
        }
    return pixels;
}

TEST(JpegFrame, shows_its_colours) {
    RgbaImage picture(kSize.x, kSize.y);
    FrameDecoder decoder(jpegFormat(kSize));
    ASSERT_TRUE(decoder.decode(jpegByLibav(), picture));
    expectBars(picture, 8);

    // libjpeg's colours have half the size in both directions, so the bars are twice as wide.
    constexpr int kTwice = 2;
    cv::Mat bars(kSize.y * kTwice, kSize.x * kTwice, CV_8UC3);
    for (int y = 0; y < bars.rows; ++y)
        for (int x = 0; x < bars.cols; ++x) {
            const Rgba8 colour = barAt(x / kTwice);
            bars.at<cv::Vec3b>(y, x) = {colour.b, colour.g, colour.r};
        }
    RgbaImage large(bars.cols, bars.rows);
    ASSERT_TRUE(FrameDecoder(jpegFormat({bars.cols, bars.rows})).decode(jpegByLibjpeg(bars), large));
    expectBars(resized(large, kSize.x, kSize.y), 8);
}

TEST(JpegFrame, without_colours_is_grey) {
    RgbaImage picture(kSize.x, kSize.y);
    ASSERT_TRUE(
        FrameDecoder(jpegFormat(kSize)).decode(jpegByLibjpeg(cv::Mat(kSize.y, kSize.x, CV_8UC1, cv::Scalar(77))), picture));
    EXPECT_EQ(picture.at(40, 20), (Rgba8{77, 77, 77, 255}));
}

// Nothing may be written beyond the end of the picture or of the decoder's own memory, or read
// beyond the frame's padding.
// Example failures: the heap is overwritten beyond the picture; the last columns are not written.
TEST(CodedFrame, of_every_width_is_right_to_the_last_pixel_and_nothing_is_touched_behind_it) {
    constexpr int kRows = 4;
    for (const FrameCoding coding :
         {FrameCoding::Yuyv, FrameCoding::Nv12, FrameCoding::Uyvy, FrameCoding::Rgb24, FrameCoding::Mjpg, FrameCoding::Grey}) {
        const bool twoByTwo = coding == FrameCoding::Yuyv || coding == FrameCoding::Nv12 || coding == FrameCoding::Uyvy;
        for (int width = 2; width <= 130; width += twoByTwo ? 2 : 1) {
            const glm::ivec2 size(width, kRows);
            const FrameFormat format{coding, size, minStride(coding, width), true, LumaWeights::Rec601};
            RgbaImage wanted = shaded(size);
            if (coding == FrameCoding::Grey)
                for (Rgba8& pixel : wanted.pixels()) {
                    const std::uint8_t luma = componentsOf(pixel, format.weights, format.fullRange).y;
                    pixel = {luma, luma, luma, 255};
                }
            const Bytes bytes = coding == FrameCoding::Mjpg ? jpegByLibjpeg(matOf(wanted)) : coded(format, shadeAt);
            FrameDecoder decoder(format);
            const FencedAllocations fence;
            const std::size_t room = bytes.size() + FrameDecoder::kPadding, before = (16 - room % 16) % 16;
            Bytes fenced(before + room, kRubbish);
            const std::span<std::uint8_t> frame(fenced.data() + before, bytes.size());
            std::ranges::copy(bytes, frame.begin());
            RgbaImage picture(width, kRows, {1, 2, 3, 4});
            ASSERT_TRUE(decoder.decode(frame, picture));
            const WorstPixel difference = differenceOf(picture, wanted);
            const int tolerance = coding == FrameCoding::Mjpg ? 6 : 3;
            EXPECT_LE(difference.most, tolerance)
                << nameOf(coding) << ", " << width << " wide, at " << difference.at.x << "," << difference.at.y;
        }
    }
}

// A cable that is too long loses packets, and decoding gives a torn picture. JPEG has no checksum:
// if a packet is lost in the middle, the rest may happen to make sense.
TEST(JpegFrame, that_lost_a_part_is_refused_and_the_next_one_is_not) {
    cv::Mat noise(240, 320, CV_8UC3);
    Rng rng(1);
    for (int i = 0; i < noise.rows * noise.cols * 3; ++i) noise.data[i] = static_cast<std::uint8_t>(rng.below(256));
    const Bytes whole = jpegByLibjpeg(noise);
    RgbaImage picture(noise.cols, noise.rows);
    FrameDecoder decoder(jpegFormat({noise.cols, noise.rows}));
    constexpr std::size_t kPacket = 512;
    int losses = 0, found = 0;
    for (std::size_t lost = 1000; lost + 2 * kPacket < whole.size(); lost += whole.size() / 40) {
        Bytes torn = whole;
        torn.erase(torn.begin() + static_cast<std::ptrdiff_t>(lost), torn.begin() + static_cast<std::ptrdiff_t>(lost + kPacket));
        ++losses;
        found += decoder.decode(torn, picture) ? 0 : 1;
        torn = whole;
        torn.resize(lost);
        EXPECT_FALSE(decoder.decode(torn, picture)) << "cut at " << lost;
    }
    EXPECT_GT(found, losses * 3 / 4) << "of " << losses;
    EXPECT_TRUE(decoder.decode(whole, picture)) << "what was damaged leaves nothing behind";
}

TEST(JpegFrame, that_is_none_or_of_another_size_is_refused) {
    RgbaImage picture(kSize.x, kSize.y);
    FrameDecoder decoder(jpegFormat(kSize));
    EXPECT_FALSE(decoder.decode({}, picture));
    EXPECT_FALSE(decoder.decode(Bytes(5000, 0), picture));
    EXPECT_FALSE(decoder.decode(jpegByLibjpeg(cv::Mat(kSize.y, kSize.x + 16, CV_8UC1, cv::Scalar(77))), picture));
    EXPECT_TRUE(decoder.decode(jpegByLibav(), picture));
}

// The peak address space of this process, MB.
long mostMemory() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmPeak:")) return std::stol(line.substr(7)) / 1024;
    return 0;
}

// A damaged header of a small frame may state any size. Example failure: 500 MB for each frame of a
// bad cable.
TEST(JpegFrame, that_says_it_is_huge_takes_no_memory) {
    Bytes frame = jpegByLibav();
    constexpr std::array<std::uint8_t, 2> kSizeFollows{0xff, 0xc0};
    const auto header = std::ranges::search(frame, kSizeFollows).begin();
    ASSERT_LT(header + 9, frame.end());
    for (const int side : {5, 7}) {  // 16000 lines with as many pixels each
        header[side] = 16000 >> 8;
        header[side + 1] = 16000 & 0xff;
    }
    frame.resize(2'000'000);  // the minimum size of such a picture for libav
    RgbaImage picture(kSize.x, kSize.y);
    FrameDecoder decoder(jpegFormat(kSize));
    const long before = mostMemory();
    const auto decoded = decoder.decode(frame, picture);
    ASSERT_FALSE(decoded);
    EXPECT_THAT(decoded.error().message(), testing::HasSubstr("larger than the expected 96 x 32 pixels"));
    EXPECT_GT(before, 0);
    EXPECT_LT(mostMemory() - before, 200);
}

}  // namespace
}  // namespace fantascope::drivers
