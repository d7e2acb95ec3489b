#include "app/base/video_writer.h"

#include "app/video_reader.h"

#include "allocations.h"
#include "pictures.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

namespace fantascope::app {
namespace {

struct Kind {
    VideoKind kind;
    const char* file;
    int tolerance;  // stored steps of 255
};
constexpr Kind kKinds[] = {{VideoKind::Recording, "recording.mp4", 3},
                           {VideoKind::Film, "film.mp4", 3},
                           {VideoKind::ProRes4444, "a.mov", 1},
                           {VideoKind::Lossless, "a.mkv", 0}};

// Colours must not shift. Example failure: the usual matrix of small pictures under the label of
// large ones.
TEST(VideoWriter, keeps_colours) {
    const ScratchFolder folder;
    const Rgba8 colours[] = {{200, 60, 20, 255}, {20, 200, 60, 255}, {40, 20, 220, 255}, {0, 0, 0, 255}, {255, 255, 255, 255}};
    for (const Kind& kind : kKinds) {
        SCOPED_TRACE(kind.file);
        auto writer = VideoWriter::open(folder / kind.file, {64, 48}, 25, kind.kind);
        ASSERT_TRUE(writer) << writer.error().message();
        int number = 0;
        for (const Rgba8& colour : colours) ASSERT_TRUE((*writer)->write(RgbaImage(64, 48, colour), number++));
        ASSERT_TRUE((*writer)->finish());
        const Video video = readVideo(folder / kind.file);
        ASSERT_EQ(video.frames.size(), std::size(colours));
        for (std::size_t i = 0; i < video.frames.size(); ++i) {
            const Rgba16 seen = video.frames[i].at(20, 30);
            EXPECT_NEAR(seen.r / 257.0, colours[i].r, kind.tolerance + 0.5) << i;
            EXPECT_NEAR(seen.g / 257.0, colours[i].g, kind.tolerance + 0.5) << i;
            EXPECT_NEAR(seen.b / 257.0, colours[i].b, kind.tolerance + 0.5) << i;
        }
    }
}

// Neither the picture nor the writer's own memory may be touched behind its end. A film of an odd
// width lacks its last column. Example failure: the last columns are made of what happened to be in
// memory.
TEST(VideoWriter, is_right_to_the_last_pixel_at_every_width_and_touches_nothing_behind_it) {
    constexpr int kRows = 4;
    const ScratchFolder folder;
    for (const Kind& kind : kKinds)
        // libav's FFV1 loses pictures that are 2 pixels wide, in its own program too.
        for (int width = kind.kind == VideoKind::Lossless ? 3 : 2; width <= 130; ++width) {
            auto writer = VideoWriter::open(folder / kind.file, {width, kRows}, 25, kind.kind).value();
            const RgbaImage wanted = shaded({width, kRows});
            {
                const FencedAllocations fence;
                const RgbaImage picture = wanted;
                ASSERT_TRUE(writer->write(picture, 0));
            }
            ASSERT_TRUE(writer->finish());
            const Video video = readVideo(folder / kind.file);
            ASSERT_EQ(video.frames.size(), 1u);
            const bool even = kind.kind == VideoKind::Recording || kind.kind == VideoKind::Film;
            RgbaImage seen(video.frames[0].width(), video.frames[0].height());
            ASSERT_EQ(seen.width(), even ? width & ~1 : width);
            std::ranges::transform(video.frames[0].pixels(), seen.pixels().begin(), [](const Rgba16& pixel) {
                const auto byte = [](std::uint16_t word) { return static_cast<std::uint8_t>(word / 257); };
                return Rgba8{byte(pixel.r), byte(pixel.g), byte(pixel.b), byte(pixel.a)};
            });
            const WorstPixel difference = differenceOf(seen, wanted);
            EXPECT_LE(difference.most, even ? 12 : kind.tolerance + 2)
                << kind.file << ", " << width << " wide, at " << difference.at.x << "," << difference.at.y;
        }
}

// 25 frames are a second of 25 Hz, whatever was left out between them.
TEST(VideoWriter, a_gap_keeps_the_picture_and_the_last_one_lasts_a_frame) {
    const ScratchFolder folder;
    for (const Kind& kind : kKinds) {
        SCOPED_TRACE(kind.file);
        auto writer = VideoWriter::open(folder / kind.file, {64, 48}, 25, kind.kind).value();
        for (const int number : {0, 1, 10, 24}) ASSERT_TRUE(writer->write(RgbaImage(64, 48), number));
        ASSERT_TRUE(writer->finish());
        const Video video = readVideo(folder / kind.file);
        ASSERT_EQ(video.times.size(), 4u);
        EXPECT_NEAR(video.times[2], 10 / 25.0, 1e-3);
        EXPECT_NEAR(video.times[3], 24 / 25.0, 1e-3);
        EXPECT_NEAR(video.seconds, 1.0, 1e-3);
    }
}

TEST(VideoWriter, leaves_nothing_where_it_was_not_finished) {
    const ScratchFolder folder;
    for (const Kind& kind : kKinds) {
        auto writer = VideoWriter::open(folder / kind.file, {64, 48}, 25, kind.kind).value();
        ASSERT_TRUE(writer->write(RgbaImage(64, 48), 0));
        EXPECT_TRUE(folder.names().empty()) << "nor where the program is killed now";
    }
    EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace fantascope::app
