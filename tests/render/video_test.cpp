#include "render/source/picture_source.h"
#include "render/source/video_stream.h"

#include "allocations.h"
#include "contract/eventually.h"
#include "core/file.h"
#include "pictures.h"
#include "scratch_folder.h"
#include "test_video.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <thread>

namespace fantascope::render {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using Pace = VideoStream::Pace;

template <class T>
T valueOf(Result<T> result) {
    FANTASCOPE_CHECK(result.has_value(), result.error().message());
    return std::move(result).value();
}

// The number on the frame that a reader shows; -1 before the first.
class Seen {
public:
    explicit Seen(std::shared_ptr<VideoStream> stream) : reader_(std::move(stream)) {}
    int at(Time position) {
        reader_.at(position, [&](const RgbaImage& picture) { number_ = numberOn(picture); });
        return number_;
    }

private:
    VideoStream::Reader reader_;
    int number_ = -1;
};

class Videos : public testing::Test {
protected:
    // A video whose frames show their numbers, from 1, so that none is black.
    std::filesystem::path make(const std::string& name, const VideoCoding& coding, int frames) const {
        writeVideo(folder_ / name, coding, frames, [&](int i) { return numbered(coding.size, i + 1); });
        return folder_ / name;
    }
    std::shared_ptr<VideoStream> open(const std::filesystem::path& file, Pace pace = Pace::Exact) const {
        return valueOf(VideoStream::open(file, pace));
    }
    std::string refusal(const std::filesystem::path& file) const {
        const auto stream = VideoStream::open(file, Pace::Exact);
        return stream ? "accepted" : folder_.relative(stream.error().message());
    }
    const ScratchFolder folder_;
};

struct Rate {
    int rate, divisor;
};
constexpr Rate kRates[] = {{24, 1}, {25, 1}, {30000, 1001}, {30, 1}, {24000, 1001}};

// Tests every frame's first and last nanosecond, in formats with exact times and in those with
// milliseconds. Example failures: the next frame is shown; frames come in decoding order; the last
// ones are lost to the decoder's delay.
TEST_F(Videos, show_exactly_the_frame_of_the_moment) {
    for (const auto& [rate, divisor] : kRates)
        for (const int bFrames : {0, 3})
            for (const char* ending : {"mp4", "mkv"}) {
                SCOPED_TRACE(fmt::format("{}/{} Hz, {} B-frames, {}", rate, divisor, bFrames, ending));
                const auto stream = open(make(std::string("a.") + ending,
                                              {.rate = rate, .rateDivisor = divisor, .bFrames = bFrames, .keyEvery = 12}, 40));
                const auto& frames = stream->content().frames;
                ASSERT_EQ(frames.size(), 40u);
                const double period = static_cast<double>(divisor) / rate,
                             unit = *ending == 'm' && ending[1] == 'k' ? 0.5e-3 : 1e-9;
                EXPECT_NEAR(seconds(stream->content().length), 40 * period, 2 * unit);
                Seen seen(stream);
                for (int i = 0; i < 40; ++i) {
                    const auto number = static_cast<std::size_t>(i);
                    ASSERT_NEAR(seconds(frames[number].begins), i * period, 1.01 * unit);
                    ASSERT_EQ(seen.at(frames[number].begins), i + 1);
                    const Time end = i == 39 ? stream->content().length : frames[number + 1].begins;
                    ASSERT_EQ(seen.at(end - Time(1)), i + 1);
                }
                EXPECT_EQ(stream->lateFrames(), 0);
            }
}

TEST_F(Videos, show_each_frame_for_as_long_as_the_file_says) {
    const std::vector<std::int64_t> begins = {0, 1, 2, 7, 8, 20, 21, 22, 23, 40};
    const VideoCoding coding{.rate = 50, .bFrames = 2};
    for (const char* name : {"a.mp4", "a.mkv", "a.mov"}) {
        SCOPED_TRACE(name);
        writeVideo(folder_ / name, coding, begins, [&](int i) { return numbered(coding.size, i + 1); });
        const auto stream = open(folder_ / name);
        Seen seen(stream);
        EXPECT_EQ(stream->content().length, std::chrono::milliseconds(41 * 20));
        for (int tick = 0; tick <= 40; ++tick) {
            const auto after = std::ranges::upper_bound(begins, tick);
            ASSERT_EQ(seen.at(std::chrono::milliseconds(20 * tick)), static_cast<int>(after - begins.begin())) << tick;
        }
    }
}

// Every frame can be reached, wherever the encoder has put keyframes.
// Example failure: with open groups of pictures, a frame that is shown before the keyframe after
// which it was encoded.
TEST_F(Videos, come_to_the_right_frame_from_any_other) {
    for (const char* name : {"a.mp4", "a.mkv", "a.ts", "a.mov"})
        for (const bool openGroups : {false, true}) {
            SCOPED_TRACE(fmt::format("{} {}", name, openGroups));
            const auto stream = open(make(name, {.bFrames = 3, .keyEvery = 10, .openGroups = openGroups}, 73));
            Seen seen(stream);
            const auto& frames = stream->content().frames;
            ASSERT_EQ(frames.size(), 73u);
            std::size_t at = 0;
            for (int jump = 0; jump < 100; ++jump) {
                at = (at * 31 + 17) % frames.size();
                ASSERT_EQ(seen.at(frames[at].begins), static_cast<int>(at) + 1);
            }
        }
}

TEST_F(Videos, of_other_coders_are_right_too) {
    for (const auto& [name, encoder, pixels] : {std::array{"a.mov", "prores_ks", "yuv444p10le"},
                                                {"a.mkv", "ffv1", "yuv420p"},
                                                {"a.webm", "libvpx-vp9", "yuv420p"},

                                                {"a.avi", "mjpeg", "yuvj420p"},
                                                {"a.mpg", "mpeg2video", "yuv420p"}}) {
        SCOPED_TRACE(encoder);
        const auto stream = open(make(name, {.encoder = encoder, .pixels = pixels}, 30));
        Seen seen(stream);
        ASSERT_EQ(stream->content().frames.size(), 30u);
        for (const std::size_t i : {0u, 1u, 29u, 3u, 28u, 12u, 13u, 11u})
            ASSERT_EQ(seen.at(stream->content().frames[i].begins), static_cast<int>(i) + 1);
    }
}

// If the show waits, no frame is late over many loops: none comes twice, none is missing, at either
// rate.
TEST_F(Videos, loop_without_a_gap) {
    const auto stream = open(make("a.mp4", {.rate = 30, .bFrames = 3, .keyEvery = 250}, 47));
    const VideoSource source{.stream = stream};
    Seen seen(stream);
    for (std::int64_t refresh = 0; refresh < 47 * 5; ++refresh)
        ASSERT_EQ(seen.at(*positionAt(source, tickTime(refresh, 30))), refresh % 47 + 1) << refresh;
    // At another rate than the video's, each frame is followed by itself or by the next one.
    int before = seen.at(Time{});
    for (std::int64_t refresh = 1; refresh < 400; ++refresh) {
        const int now = seen.at(*positionAt(source, tickTime(refresh, 50)));
        ASSERT_TRUE(now == before || now == before % 47 + 1) << before << " " << now;
        before = now;
    }
}

// Example failures: the second time begins with the file's first frame; a part that ends dark shows
// its last frame once more.
TEST_F(Videos, play_a_part_as_often_as_asked) {
    const auto stream = open(make("a.mp4", {.rate = 25, .bFrames = 3, .keyEvery = 250}, 47));
    VideoSource source{.stream = stream, .from = tickTime(10, 25), .to = tickTime(20, 25), .times = 2, .endsDark = true};
    Seen seen(stream);
    for (std::int64_t refresh = 0; refresh < 20; ++refresh)
        ASSERT_EQ(seen.at(*positionAt(source, tickTime(refresh, 25))), 11 + refresh % 10) << refresh;
    EXPECT_EQ(positionAt(source, tickTime(20, 25)), std::nullopt);
    EXPECT_EQ(seen.at(*positionAt(source, -1s)), 11) << "before it has begun";
    source.endsDark = false;
    EXPECT_EQ(seen.at(*positionAt(source, 9h)), 20);
    source.times = 0;
    EXPECT_EQ(seen.at(*positionAt(source, tickTime(1000, 25))), 11);
    source.to = {};
    EXPECT_EQ(seen.at(*positionAt(source, tickTime(36, 25))), 47) << "to its end";
    EXPECT_EQ(seen.at(*positionAt(source, tickTime(37, 25))), 11);
}

// What the next cue needs is there before GO.
// Example failure: a part in the middle begins with the first frame of the file, until the decoder
// has come there.
TEST_F(Videos, that_begin_in_the_middle_have_their_first_frames_ready) {
    const auto file = make("a.mp4", {.rate = 25, .bFrames = 0, .keyEvery = 250}, 300);
    const auto stream = valueOf(VideoStream::open(file, Pace::Exact, tickTime(250, 25)));
    {
        Seen early(stream);  // the opening is decoded by then
        EXPECT_EQ(early.at(tickTime(253, 25)), 254);
    }
    Seen seen(stream);
    EXPECT_EQ(seen.at(tickTime(250, 25)), 251);
    const auto late = VideoStream::open(file, Pace::Exact, 12s);
    ASSERT_FALSE(late);
    EXPECT_EQ(folder_.relative(late.error().message()), "a.mp4: it is 12.000 s long, so it cannot begin at 12.000 s");
}

// Waits until the decoding thread has reached a frame, and collects the frames seen until then.
std::set<int> until(Seen& seen, Time position, int wanted) {
    std::set<int> numbers;
    for (int number = seen.at(position); number != wanted; number = seen.at(position)) {
        numbers.insert(number);
        std::this_thread::yield();
    }
    return numbers;
}

// A live show never waits: while a frame is late, the last one stays.
TEST_F(Videos, keep_the_last_frame_until_a_late_one_comes) {
    const auto stream = open(make("a.mp4", {.bFrames = 3, .keyEvery = 250}, 200), Pace::Live);
    const auto begins = [&](std::size_t i) { return stream->content().frames[i].begins; };
    Seen seen(stream);
    EXPECT_EQ(seen.at(begins(0)), 1) << "the first frame is decoded before the show";
    until(seen, begins(3), 4);
    for (const int number : until(seen, begins(150), 151)) EXPECT_TRUE(number >= 4 && number <= 10) << number;
    EXPECT_GE(stream->lateFrames(), 1);
    const std::int64_t late = stream->lateFrames();
    EXPECT_EQ(seen.at(begins(0)), 1) << "a video restarts at once";
    EXPECT_EQ(seen.at(begins(2)), 3);
    EXPECT_EQ(stream->lateFrames(), late);
    until(seen, begins(151), 152);
}

// The same video began at different times on two outputs: neither disturbs the other.
TEST_F(Videos, serve_outputs_that_are_at_different_moments) {
    const auto stream = open(make("a.mp4", {.bFrames = 3, .keyEvery = 250}, 300));
    Seen left(stream), right(stream), same(stream);
    for (std::size_t i = 0; i < 600; ++i) {
        const auto position = [&](std::size_t frame) { return stream->content().frames[frame % 300].begins; };
        ASSERT_EQ(left.at(position(i)), static_cast<int>(i % 300) + 1);
        ASSERT_EQ(same.at(position(i)), static_cast<int>(i % 300) + 1);
        ASSERT_EQ(right.at(position(i + 140)), static_cast<int>((i + 140) % 300) + 1);
    }
}

TEST_F(Videos, are_read_without_allocating) {
    for (const Pace pace : {Pace::Exact, Pace::Live}) {
        const auto stream = open(make("a.mp4", {.bFrames = 3}, 60), pace);
        VideoStream::Reader reader(stream);
        int shown = 0;
        const std::int64_t before = allocationsSoFar();
        for (std::int64_t refresh = 0; refresh < 200; ++refresh)
            reader.at(tickTime(refresh, 25) % stream->content().length, [&](const RgbaImage&) { ++shown; });
        EXPECT_EQ(allocationsSoFar() - before, 0);
        EXPECT_GE(shown, 1);
    }
}

// Colours follow the matrix and range that the file states, or those implied by its height.
TEST_F(Videos, keep_their_colours) {
    const Rgba8 colours[] = {{200, 60, 20, 255}, {20, 200, 60, 255}, {40, 20, 220, 255}, {0, 0, 0, 255}, {255, 255, 255, 255}};
    struct Case {
        const char *name, *encoder, *pixels, *matrix, *range;
        glm::ivec2 size;
        int tolerance;
    };
    for (const Case& one : {Case{"a.mp4", "libx264", "yuv420p", "bt709", "tv", {64, 48}, 4},
                            {"b.mp4", "libx264", "yuv420p", "smpte170m", "tv", {64, 48}, 4},
                            {"c.mp4", "libx264", "yuv444p", "bt709", "pc", {64, 48}, 4},
                            {"d.mp4", "libx264", "yuv420p", "unknown", "tv", {64, 720}, 4},
                            {"e.mkv", "ffv1", "bgr0", "gbr", "pc", {64, 48}, 0},
                            {"f.mkv", "ffv1", "rgba64le", "gbr", "pc", {64, 48}, 1},
                            {"g.mov", "prores_ks", "yuv444p10le", "bt709", "tv", {64, 48}, 2}}) {
        SCOPED_TRACE(one.name);
        writeVideo(folder_ / one.name,
                   {.encoder = one.encoder, .pixels = one.pixels, .size = one.size, .matrix = one.matrix, .range = one.range}, 5,
                   [&](int i) { return RgbaImage(one.size.x, one.size.y, colours[i]); });
        const auto stream = open(folder_ / one.name);
        VideoStream::Reader reader(stream);
        for (std::size_t i = 0; i < 5; ++i) {
            Rgba8 seen;
            reader.at(stream->content().frames[i].begins, [&](const RgbaImage& picture) { seen = picture.at(30, 20); });
            EXPECT_NEAR(seen.r, colours[i].r, one.tolerance) << i;
            EXPECT_NEAR(seen.g, colours[i].g, one.tolerance) << i;
            EXPECT_NEAR(seen.b, colours[i].b, one.tolerance) << i;
            EXPECT_EQ(seen.a, 255);
        }
    }
}

// The file has straight alpha; an alpha of 0.5 gives half of the light.
TEST_F(Videos, keep_their_alpha) {
    for (const auto& [name, encoder, pixels] : {std::array{"a.mov", "prores_ks", "yuva444p10le"}, {"a.mkv", "ffv1", "bgra"}}) {
        SCOPED_TRACE(name);
        writeVideo(folder_ / name, {.encoder = encoder, .pixels = pixels}, 1, [&](int) {
            RgbaImage picture(64, 64, {255, 255, 255, 128});
            for (int y = 0; y < 64; ++y)
                for (int x = 32; x < 64; ++x) picture.at(x, y).a = 0;
            return picture;
        });
        VideoStream::Reader reader(open(folder_ / name));
        reader.at(Time{}, [&](const RgbaImage& picture) {
            EXPECT_NEAR(picture.at(10, 10).a, 128, 1);
            EXPECT_NEAR(picture.at(10, 10).r, 188, 2);
            EXPECT_NEAR(picture.at(50, 10).a, 0, 1);
            EXPECT_NEAR(picture.at(50, 10).r, 0, 3);
        });
    }
}

// Nothing may be written behind the end of the picture or of the decoder's own memory.
WorstPixel differenceOfFirstFrame(const std::filesystem::path& file, const RgbaImage& wanted) {
    const auto decoder = valueOf(VideoDecoder::open(valueOf(VideoDecoder::examine(file))));
    FANTASCOPE_CHECK(decoder->next() == 0u, "the first frame");
    const FencedAllocations fence;
    RgbaImage seen(wanted.width(), wanted.height(), {1, 2, 3, 4});
    decoder->picture(seen);
    return differenceOf(seen, wanted);
}

// Example failures: the heap behind the picture is overwritten; the last columns are not written.
TEST_F(Videos, of_every_width_are_right_to_the_last_pixel_and_nothing_is_written_behind_it) {
    constexpr int kRows = 4;
    for (const char* pixels : {"yuv420p", "yuv422p", "yuv444p", "yuva420p", "yuv420p10le", "bgra"})
        for (int width = 1; width <= 130; ++width) {
            const RgbaImage wanted = shaded({width, kRows});
            writeVideo(folder_ / "a.mkv", {.encoder = "ffv1", .pixels = pixels, .size = {width, kRows}}, 1,
                       [&](int) { return wanted; });
            const WorstPixel difference = differenceOfFirstFrame(folder_ / "a.mkv", wanted);
            EXPECT_LE(difference.most, 3) << pixels << ", " << width << " wide, at " << difference.at.x << "," << difference.at.y;
        }
}

TEST_F(Videos, of_real_sizes_are_right_to_the_last_pixel) {
    constexpr glm::ivec2 kSizes[] = {{128, 96},  {176, 144}, {160, 120}, {192, 144}, {200, 120},  {240, 160},
                                     {256, 144}, {270, 480}, {300, 300}, {320, 180}, {320, 240},  {352, 288},
                                     {360, 640}, {400, 240}, {416, 234}, {424, 240}, {426, 240},  {480, 270},
                                     {480, 360}, {568, 320}, {640, 360}, {854, 480}, {1366, 768}, {1080, 1920}};
    for (const glm::ivec2 size : kSizes) {
        const RgbaImage wanted = shaded(size);
        writeVideo(folder_ / "a.mkv", {.encoder = "ffv1", .size = size}, 1, [&](int) { return wanted; });
        const WorstPixel difference = differenceOfFirstFrame(folder_ / "a.mkv", wanted);
        EXPECT_LE(difference.most, 3) << size.x << " x " << size.y << ", at " << difference.at.x << "," << difference.at.y;
    }
}

// A pixel format that libav decodes but libswscale cannot read.
constexpr const char* kNotConverted = "uyyvyy411";

// Example failure: a decoder counts the padding of a portrait frame's rows as pixels, and refuses
// it as too large.
TEST_F(Videos, of_the_largest_size_are_shown_lying_and_upright) {
    for (const glm::ivec2 size : {glm::ivec2(8192, 4320), {4320, 8192}}) {
        writeVideo(folder_ / "a.mov", {.encoder = "qtrle", .pixels = "gray", .size = size}, 1, [](int) { return RgbaImage(); });
        EXPECT_EQ(refusal(folder_ / "a.mov"), "accepted") << size.x << " x " << size.y;
    }
}

TEST_F(Videos, that_are_broken_are_refused_with_advice) {
    EXPECT_THAT(refusal(folder_ / "absent.mp4"), HasSubstr("absent.mp4: not a video that can be read"));
    EXPECT_THAT(refusal(folder_.file("text.mp4", "no video at all, only words\n")),
                HasSubstr("text.mp4: not a video that can be read, or a truncated one"));
    EXPECT_THAT(refusal(folder_.file("empty.mp4", "")), HasSubstr("empty.mp4: "));
    // Only sound: a second of silence.
    std::string wave("RIFF\x24\x3e\0\0WAVEfmt \x10\0\0\0\1\0\1\0\x40\x1f\0\0\x80\x3e\0\0\2\0\x10\0data\x80\x3e\0\0", 44);
    wave.resize(44 + 16000);
    EXPECT_THAT(refusal(folder_.file("sound.wav", wave)), HasSubstr("sound.wav: there is no video in it; "));

    // 5 s, truncated in the middle: with the index at the beginning, as in streams, with it at the
    // end, and without one.
    const auto cut = [&](const std::filesystem::path& file) {
        const std::string bytes = readFile(file).value();
        return folder_.file("cut-" + file.filename().string(), std::string_view(bytes).substr(0, bytes.size() / 2));
    };
    EXPECT_THAT(refusal(cut(make("a.mp4", {}, 125))), HasSubstr("cut-a.mp4: not a video that can be read, or a truncated one"));
    EXPECT_THAT(refusal(cut(make("a.mkv", {}, 125))), HasSubstr("cut-a.mkv: truncated: it ends after "));
    writeVideo(folder_ / "large.mov", {.encoder = "qtrle", .pixels = "gray", .size = {8200, 4400}}, 1,
               [](int) { return RgbaImage(); });
    EXPECT_THAT(refusal(folder_ / "large.mov"), HasSubstr("large.mov: 8200 x 4400 pixels are too many; at most 8192 x 4320"));
    for (const glm::ivec2 size : {glm::ivec2(8194, 64), {64, 8194}}) {
        writeVideo(folder_ / "long.mkv", {.encoder = "ffv1", .pixels = "gray", .size = size}, 1, [](int) { return RgbaImage(); });
        EXPECT_THAT(refusal(folder_ / "long.mkv"),
                    HasSubstr(fmt::format("long.mkv: {} x {} pixels are too many", size.x, size.y)));
    }

    writeVideo(folder_ / "odd.mkv", {.encoder = "rawvideo", .pixels = kNotConverted}, 3, [](int) { return RgbaImage(); });
    EXPECT_THAT(refusal(folder_ / "odd.mkv"),
                HasSubstr("odd.mkv: its pixels are stored as 'uyyvyy411', which cannot be converted; export it again"));

    ASSERT_EQ(::mkfifo((folder_ / "pipe.mp4").c_str(), 0600), 0);
    EXPECT_EQ(refusal(folder_ / "pipe.mp4"), "pipe.mp4: is a pipe, a file is needed");
    EXPECT_EQ(refusal("/dev/zero"), "/dev/zero: is a device, a file is needed");
    // A list of other files is not a video.
    make("part.mp4", {}, 5);
    for (const char* list : {"ffconcat version 1.0\nfile part.mp4\n", "#EXTM3U\n#EXTINF:1,\npart.mp4\n#EXT-X-ENDLIST\n"})
        EXPECT_THAT(refusal(folder_.file("list.mp4", list)), HasSubstr("list.mp4: ")) << list;
}

// Example failures: the show waits forever for a frame that never comes; grey blocks appear; the
// rest is lost too.
TEST_F(Videos, leave_out_what_is_damaged_and_go_on) {
    for (const auto& [name, encoder, pixels] : {std::array{"a.mp4", "libx264", "yuv420p"}, {"a.mov", "png", "rgb24"}}) {
        SCOPED_TRACE(name);
        writeVideo(folder_ / name, {.encoder = encoder, .pixels = pixels, .size = {128, 128}, .keyEvery = 1}, 100, [](int i) {
            return noisy({128, 128}, i + 1);
        });
        damage(folder_ / name, 0.42, 0.48);
        const auto stream = open(folder_ / name);
        const auto& frames = stream->content().frames;
        Seen seen(stream);
        int good = 0, before = 0, last = 0;
        for (std::size_t i = 0; i < frames.size(); ++i) {
            const int number = seen.at(frames[i].begins), own = static_cast<int>(i) + 1;
            ASSERT_TRUE(number == own || number == before) << own << " shows " << number;
            good += number == own;
            before = number;
            last = own;
        }
        EXPECT_EQ(before, last) << "the end is whole again";
        EXPECT_GE(good, static_cast<int>(frames.size()) - 12);
        EXPECT_LT(good, 100);
        EXPECT_EQ(seen.at(Time{}), 1) << "and it comes round";
        const auto missing = static_cast<std::int64_t>(frames.size()) - good;
        EXPECT_EQ(stream->damagedFrames(), missing) << "each once";
        for (const VideoContent::Frame& frame : frames) seen.at(frame.begins);
        EXPECT_EQ(stream->damagedFrames(), 2 * missing) << "and once more each time round";
        EXPECT_EQ(stream->lateFrames(), 0);
    }
}

// A format that a file comes to halfway, or another version of it, is met by the decoding thread of
// a running show.
// Example failure: the program ends.
TEST_F(Videos, leave_out_frames_whose_pixels_cannot_be_converted) {
    const auto file = folder_ / "a.mkv";
    const auto write = [&](const char* pixels) {
        writeVideo(file, {.encoder = "rawvideo", .pixels = pixels}, 3, [](int) { return RgbaImage(); });
    };
    write("gray");
    const auto content = valueOf(VideoDecoder::examine(file));
    write(kNotConverted);
    const auto decoder = valueOf(VideoDecoder::open(content));
    EXPECT_EQ(decoder->next(), std::nullopt);
    EXPECT_THAT(decoder->damage(), HasSubstr("a.mkv: after frame 0: its pixels are stored as 'uyyvyy411'"));
}

// Example failures: a machine that is short of memory for a second ends the show; the opening,
// which is decoded once, stays lost.
TEST_F(Videos, leave_out_frames_for_which_there_is_no_memory_and_go_on) {
    const auto file = make("a.mp4", {.keyEvery = 1}, 40);
    std::shared_ptr<VideoStream> stream;
    std::unique_ptr<Seen> seen;
    {
        const FailingAllocations failing;
        stream = open(file);
        seen = std::make_unique<Seen>(stream);
        for (const VideoContent::Frame& frame : stream->content().frames) ASSERT_EQ(seen->at(frame.begins), 1);
        EXPECT_GE(failing.failures(), 39);
        EXPECT_EQ(stream->damagedFrames(), 39);
    }
    contract::eventually("every frame is there", [&] {
        int number = 0;
        return std::ranges::all_of(stream->content().frames,
                                   [&](const auto& frame) { return seen->at(frame.begins) == ++number; });
    });
}

// Example failures: the program ends; frames stand still for good.
TEST_F(Videos, go_on_after_a_moment_without_any_memory) {
    const auto stream = open(make("a.mp4", {.keyEvery = 1}, 40), Pace::Live);
    const auto& frames = stream->content().frames;
    std::deque<Seen> readers;
    {
        const FailingAllocations failing;
        // The decoding thread has to note what more readers ask for than it was prepared for.
        for (int i = 0; i < 40; ++i) readers.emplace_back(stream);
        contract::eventually("it fails", [&, asked = 0u]() mutable {
            readers.front().at(frames[++asked % 40].begins);
            return failing.failures() > 0;
        });
    }
    contract::eventually("frames are decoded again", [&] { return readers.front().at(frames[20].begins) == 21; });
    contract::eventually("for the others, too", [&] { return readers.back().at(frames[30].begins) == 31; });
}

// Somebody copies a new version over the file, or the disk goes: what was there stays on the wall,
// and whole again it goes on. Example failure: the show waits for ever.
TEST_F(Videos, whose_file_goes_away_stay_as_they_were) {
    const auto file = folder_ / "a.mov";
    writeVideo(file, {.encoder = "png", .pixels = "rgb24", .size = {128, 128}, .keyEvery = 1}, 100, [](int i) {
        return noisy({128, 128}, i + 1);
    });
    const std::string bytes = readFile(file).value();
    const auto stream = open(file);
    const auto begins = [&](std::size_t i) { return stream->content().frames[i].begins; };
    Seen seen(stream);
    ASSERT_EQ(seen.at(begins(40)), 41);
    std::filesystem::resize_file(file, 100);
    EXPECT_EQ(seen.at(begins(80)), 41);
    EXPECT_EQ(seen.at(begins(20)), 41);
    std::ofstream(file, std::ios::binary) << bytes;
    EXPECT_EQ(seen.at(begins(60)), 61);
}

}  // namespace
}  // namespace fantascope::render
