// `fantascope export` as a person runs it, its files read back as another program would.

#include "app/export/off_screen.h"
#include "app/live/programme.h"
#include "app/video_reader.h"

#include "core/geometry.h"
#include "media/image.h"
#include "program.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::string kShow = sourceFolder() + "/shows/light-movement";

class ExportCommand : public testing::Test {
protected:
    Outcome run(const std::vector<std::string>& arguments) const { return runProgram(arguments, folder_.path()); }
    // `export SHOW --output left --size 160x90 --cue Full --seconds 0.5 --fps 12 -o ...`
    Outcome exportLeft(const std::string& target, const std::vector<std::string>& more = {},
                       const std::string& length = "0.5") const {
        std::vector<std::string> arguments = {"export", kShow,       "--output", "left",  "--size", "160x90", "--cue",
                                              "Full",   "--seconds", length,     "--fps", "12",     "-o",     target};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    }
    RgbaImage frame(const std::string& name) const { return readRgba(folder_ / name).value(); }

    const ScratchFolder folder_;
};

// The left output of the default show at full light, drawn here by the renderer itself.
class Drawn {
public:
    explicit Drawn(glm::ivec2 size) {
        app::RunOptions options;
        options.show = kShow;
        options.site = sourceFolder() + "/config/simulated";
        options.fromCue = "Full";
        const app::Programme programme = app::readProgramme(options).value();
        show::Playback playback(programme.cues);
        playback.apply(*programme.firstInput);
        show::ShowState later;
        playback.stateAt(std::chrono::minutes(1), later);
        state_ = later.outputs[0];
        const show::Site scaled = programme.site.scaled(glm::dvec2(size) / glm::dvec2(programme.site.outputs[0].size()));
        screen_ = app::OffScreen::open(scaled.outputs[0].projection, nullptr, programme.sources).value();
    }
    const RgbaImage& at(Time time) { return screen_->draw(state_, {}, time); }

private:
    show::OutputState state_;
    std::unique_ptr<app::OffScreen> screen_;
};

int mostApart(const RgbaImage& a, const RgbaImage& b) {
    int most = 0;
    for (std::size_t i = 0; i < a.pixels().size(); ++i) {
        const Rgba8 p = a.pixels()[i], q = b.pixels()[i];
        for (const int apart : {p.r - q.r, p.g - q.g, p.b - q.b}) most = std::max(most, std::abs(apart));
    }
    return most;
}

// A picture with straight alpha laid over black in stored values, as a player does.
RgbaImage overBlack(const Rgba16Image& picture) {
    RgbaImage result(picture.width(), picture.height());
    for (std::size_t i = 0; i < result.pixels().size(); ++i) {
        const Rgba16 pixel = picture.pixels()[i];
        const auto laid = [&](std::uint16_t channel) {
            return static_cast<std::uint8_t>(std::lround(255.0 * channel / 65535 * pixel.a / 65535));
        };
        result.pixels()[i] = {laid(pixel.r), laid(pixel.g), laid(pixel.b), 255};
    }
    return result;
}

// Example failures: the frame after, the refresh's time instead of the frame's, a fade that still
// runs.
TEST_F(ExportCommand, frame_k_is_what_the_renderer_draws_at_k_over_the_rate) {
    const Outcome done = exportLeft("frames", {"--alpha", "none", "--report", "r.json"});
    ASSERT_THAT(done, exits(0));
    Drawn drawn({160, 90});
    for (int k = 0; k < 6; ++k) {
        const RgbaImage picture = frame(fmt::format("frames/frame-{:06}.png", k));
        EXPECT_EQ(picture, drawn.at(tickTime(k, 12))) << k;
        if (k > 0) {
            EXPECT_NE(picture, drawn.at(tickTime(k - 1, 12))) << "it moves";
        }
    }
    EXPECT_FALSE(fs::exists(folder_ / "frames/frame-000006.png"));
    const auto report = nlohmann::json::parse(contentsOf(folder_ / "r.json"));
    EXPECT_EQ(report["frames"], 6);
    EXPECT_EQ(report["seconds"], 0.5);
    EXPECT_EQ(report["stop_reason"], "length");
}

TEST_F(ExportCommand, videos_have_every_frame_for_as_long_as_the_next) {
    for (const auto& [name, codec] : {std::pair("a.mp4", "h264"), {"a.mov", "prores"}, {"a.mkv", "ffv1"}}) {
        SCOPED_TRACE(name);
        const Outcome done = exportLeft(name, {}, "2.5");
        ASSERT_THAT(done, exits(0));
        const Video video = readVideo(folder_ / name);
        EXPECT_EQ(video.codec, codec);
        ASSERT_EQ(video.frames.size(), 30u);
        EXPECT_NEAR(video.seconds, 2.5, 2e-3);
        EXPECT_NEAR(video.framesPerSecond, 12, 1e-2);
        for (int k = 0; k < 30; ++k) EXPECT_NEAR(video.times[static_cast<std::size_t>(k)], k / 12.0, 1e-3);
    }
    for (const auto& entry : fs::directory_iterator(folder_.path())) EXPECT_NE(entry.path().extension(), ".part");
}

TEST_F(ExportCommand, what_has_alpha_gives_the_frame_again_over_black) {
    ASSERT_THAT(exportLeft("a.mkv"), exits(0));
    ASSERT_THAT(exportLeft("a.mov"), exits(0));
    ASSERT_THAT(exportLeft("frames"), exits(0));
    const Video lossless = readVideo(folder_ / "a.mkv"), prores = readVideo(folder_ / "a.mov");
    Drawn drawn({160, 90});
    for (int k = 0; k < 6; ++k) {
        const RgbaImage& wanted = drawn.at(tickTime(k, 12));
        const auto i = static_cast<std::size_t>(k);
        EXPECT_LE(mostApart(overBlack(lossless.frames[i]), wanted), 1);
        // Of a picture with 8 bits left, as readRgba gives it, two roundings are left.
        const RgbaImage png = frame(fmt::format("frames/frame-{:06}.png", k));
        Rgba16Image wide(png.width(), png.height());
        for (std::size_t p = 0; p < png.pixels().size(); ++p) {
            const auto word = [](std::uint8_t byte) { return static_cast<std::uint16_t>(257 * byte); };
            const Rgba8 pixel = png.pixels()[p];
            wide.pixels()[p] = {word(pixel.r), word(pixel.g), word(pixel.b), word(pixel.a)};
        }
        EXPECT_LE(mostApart(overBlack(wide), wanted), 1);
        // ProRes is a lossy coding, of few steps.
        const RgbaImage laid = overBlack(prores.frames[i]);
        double sum = 0;
        for (std::size_t p = 0; p < laid.pixels().size(); ++p) sum += std::abs(laid.pixels()[p].g - wanted.pixels()[p].g);
        EXPECT_LT(sum / static_cast<double>(laid.pixels().size()), 1.0);
    }
    // Clear outside the picture, opaque where a shape shines.
    EXPECT_EQ(lossless.frames[0].at(0, 0).a, 0);
    EXPECT_GT(std::ranges::max(lossless.frames[0].pixels(), {}, &Rgba16::a).a, 60000);
}

// What the projector would get in a rehearsal, by the rehearsal's own hashes of its frames.
TEST_F(ExportCommand, plays_the_cues_as_a_rehearsal_does) {
    const auto fnv = [](const RgbaImage& picture) {
        std::uint64_t hash = 0xcbf29ce484222325u;
        for (const Rgba8& pixel : picture.pixels())
            for (const std::uint8_t byte : {pixel.r, pixel.g, pixel.b}) hash = (hash ^ byte) * 0x100000001b3u;
        return hash;
    };
    ASSERT_THAT(run({"rehearse", "--seconds", "6", "--record", "rehearsal", "--as-fast-as-possible"}), exits(0));
    ASSERT_THAT(run({"export", kShow, "--output", "right", "--seconds", "6", "--fps", "3", "--alpha", "none", "-o", "frames"}),
                exits(0));
    const std::string csv = contentsOf(folder_ / "rehearsal/frames.csv");
    for (int k = 1; k < 18; ++k) {
        const RgbaImage picture = frame(fmt::format("frames/frame-{:06}.png", k));
        EXPECT_THAT(csv, HasSubstr(fmt::format(",{:.6f},right,{:016x}\n", k / 3.0, fnv(picture)))) << k;
    }
}

TEST_F(ExportCommand, a_pattern_alone_fills_the_frame_and_loops) {
    const std::string pattern = kShow + "/left.pattern.yaml";
    ASSERT_THAT(run({"export", pattern, "--size", "96x54", "--fps", "1", "--alpha", "none", "-o", "frames"}), exits(0));
    // 2000 frames at 30 Hz are one loop; at one frame a second the 67 frames come round to within a
    // frame.
    EXPECT_TRUE(fs::exists(folder_ / "frames/frame-000066.png"));
    EXPECT_FALSE(fs::exists(folder_ / "frames/frame-000067.png"));
    EXPECT_THAT(run({"export", pattern, "--cue", "Full", "-o", "more"}).errors, HasSubstr("are for shows"));
}

// Example failure: the first source's shape stands for the canvas's, whatever the cue shows.
TEST_F(ExportCommand, a_canvas_has_its_own_shape_and_another_size_is_told) {
    folder_.file("show/show.yaml", R"(fantascope: show
version: 1
title: Shapes
sources: {square: {image: square.png}, wide: {image: wide.png}}
looks: {full: {outputs: {left: [{source: wide}]}}}
cues: [{name: Full, look: full, fade: 0}]
)");
    folder_.file("site.yaml", R"(fantascope: site
version: 1
outputs: [{name: left, display: {driver: headless}, size: [640, 360], refresh_rate: 30}]
)");
    const Rgba8 white{255, 255, 255, 255};
    ASSERT_TRUE(writePng(folder_ / "show/square.png", RgbaImage(64, 64, white)));
    ASSERT_TRUE(writePng(folder_ / "show/wide.png", RgbaImage(64, 36, white)));
    const auto exported = [&](const std::string& name, const std::vector<std::string>& more) {
        std::vector<std::string> arguments = {"export", "show",      "--site", "site.yaml", "--output", "left", "--cue",
                                              "Full",   "--seconds", "0.01",   "--alpha",   "none",     "-o",   name};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runProgram(arguments, folder_.path());
    };
    ASSERT_THAT(exported("canvas", {"--canvas"}), exits(0));
    const RgbaImage canvas = frame("canvas/frame-000000.png");
    EXPECT_EQ(glm::ivec2(canvas.width(), canvas.height()), glm::ivec2(1920, 1080));
    EXPECT_EQ(canvas.at(5, 540), white) << "no dark edge";
    const Outcome stretched = exported("high", {"--size", "90x160"});
    ASSERT_THAT(stretched, exits(0));
    EXPECT_THAT(stretched.errors, HasSubstr("the picture of 'left' is 1.78 : 1 and is stretched to 0.56 : 1"));
    const Outcome small = exported("small", {"--size", "160x90"});
    ASSERT_THAT(small, exits(0));
    EXPECT_THAT(small.errors, testing::Not(HasSubstr("stretched")));
}

// The canvas is what a light mask wants: the keystone is for the projector alone.
TEST_F(ExportCommand, leaves_the_keystone_out_when_asked_to) {
    ASSERT_THAT(exportLeft("warped", {"--alpha", "none"}, "0.01"), exits(0));
    ASSERT_THAT(exportLeft("straight", {"--alpha", "none", "--canvas"}, "0.01"), exits(0));
    ASSERT_EQ(
        run({"export", kShow + "/left.pattern.yaml", "--size", "160x90", "--seconds", "0.01", "--alpha", "none", "-o", "pattern"})
            .status,
        0);
    EXPECT_EQ(frame("straight/frame-000000.png"), frame("pattern/frame-000000.png"));
    EXPECT_NE(frame("warped/frame-000000.png"), frame("pattern/frame-000000.png"));
}

TEST_F(ExportCommand, refuses_with_advice) {
    const auto refusal = [&](const std::vector<std::string>& arguments) {
        const Outcome outcome = run(arguments);
        EXPECT_THAT(outcome, exits(1));
        return outcome.errors;
    };
    const std::string show = kShow;
    EXPECT_THAT(refusal({"export", show, "-o", "a.mp4"}), HasSubstr("needs --output NAME"));
    EXPECT_THAT(refusal({"export", show, "--output", "lef", "-o", "a.mp4"}), HasSubstr("did you mean 'left'?"));
    EXPECT_THAT(refusal({"export", show, "--output", "left", "--cue", "Ful", "-o", "a.mp4"}), HasSubstr("Full"));
    EXPECT_THAT(refusal({"export", show, "--output", "left", "-o", "a.gif"}), HasSubstr("FILE.mov"));
    EXPECT_THAT(refusal({"export", show, "--output", "left", "-o", "a.mp4", "--alpha", "stored"}), HasSubstr("no alpha"));
    ASSERT_THAT(exportLeft("frames"), exits(0));
    EXPECT_THAT(exportLeft("frames").errors, HasSubstr("already has frames in it"));
    EXPECT_THAT(run({"export", show, "--output", "left", "-o", "a.mp4", "--size", "160"}), exits(2));
    EXPECT_THAT(run({"export", show, "--output", "left", "-o", "a.mp4", "--cue", "Full", "--from", "Full"}), exits(2));
    EXPECT_FALSE(fs::exists(folder_ / "a.mp4"));
}

// Ctrl-C, once the first line of progress says that frames are being drawn: what is there by then
// is a whole file.
TEST_F(ExportCommand, ctrl_c_leaves_a_file_that_plays) {
    for (const char* name : {"a.mp4", "a.mov", "a.mkv"}) {
        SCOPED_TRACE(name);
        // Two lines of progress: at the beginning, and some frames later.
        EXPECT_EQ(interruptProgram({"export", kShow, "--output", "left", "--cue", "Full", "--size", "160x90", "--seconds",
                                    "100000", "-o", name, "--report", "r.json"},
                                   folder_.path(), 2),
                  0);
        const auto report = nlohmann::json::parse(contentsOf(folder_ / "r.json"));
        EXPECT_EQ(report["stop_reason"], "interrupted");
        EXPECT_GT(report["frames"], 0);
        const Video video = readVideo(folder_ / name);
        EXPECT_EQ(video.frames.size(), report["frames"].get<std::size_t>());
    }
}

}  // namespace
}  // namespace fantascope
