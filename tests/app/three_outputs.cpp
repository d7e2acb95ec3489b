#include "app/three_outputs.h"

#include "render/scene.h"
#include "theatre/stage/cast.h"
#include "theatre/stage/stage_set.h"

#include "core/check.h"
#include "test_video.h"

#include <fmt/format.h>

#include <utility>

namespace fantascope::app {
namespace {

constexpr const char* kSite = R"(fantascope: site
version: 1
outputs:
  - name: left
    display: {}
    size: [320, 180]
    refresh_rate: 60
    canvas: wall
    part: [0, 0, 0.55, 1]
    corners: [[20, 12], [310, 4], [318, 176], [6, 170]]
    light: {{gamma: 2.2, black_level: 0.001, white: [1, 0.95, 0.9]}}
  - name: middle
    display: {}
    size: [320, 180]
    refresh_rate: 60
    canvas: wall
    part: [0.45, 0, 1, 1]
    mesh: {{points: [3, 2], offsets: [[0, 0], [0, -6], [0, 0], [0, 0], [0, 5], [0, 0]]}}
    masks: [{{polygon: [[150, 150], [170, 150], [160, 180]], feather: 6}}]
    light: {{gamma: 2.2, lut: table.cube}}
  - name: right
    display: {}
    size: [320, 180]
    refresh_rate: 60
    masks: [{{image: mask.png}}]
    light: {{dither: false}}
)";
// The corners of a cube of colours, the primaries a little mixed; red runs fastest.
constexpr const char* kTable =
    "LUT_3D_SIZE 2\n0 0 0\n0.9 0.05 0\n0 0.9 0.05\n0.95 0.95 0\n0.05 0 0.9\n0.95 0 0.95\n0 0.95 0.95\n1 1 1\n";

show::Site siteIn(const ScratchFolder& folder, const std::array<std::string, 3>& displays) {
    folder.file("table.cube", kTable);
    RgbaImage mask(32, 18, {255, 255, 255, 255});
    for (int x = 0; x < 4; ++x) mask.at(x, 0) = {0, 0, 0, 255};
    FANTASCOPE_CHECK(writePng(folder / "mask.png", mask).has_value(), "the temporary folder can be written to");
    auto site = show::readSite(folder.file("site.yaml", fmt::format(fmt::runtime(kSite), displays[0], displays[1], displays[2])));
    FANTASCOPE_CHECK(site.has_value(), site.error().message());
    return std::move(site).value();
}

std::shared_ptr<render::VideoStream> videoIn(const ScratchFolder& folder) {
    writeVideo(folder / "rain.mp4", {.size = {128, 72}, .rate = 25}, 50, [](int number) {
        return RgbaImage(128, 72, {static_cast<std::uint8_t>(number * 5), 60, 120, 255});
    });
    auto stream = render::VideoStream::open(folder / "rain.mp4", render::VideoStream::Pace::Live);
    FANTASCOPE_CHECK(stream.has_value(), stream.error().message());
    return std::move(stream).value();
}

// Somebody who turns on the spot, with a prop in his hand.
render::ShadowSource turning() {
    theatre::Cast cast;
    cast.framesPerSecond = 12;
    const theatre::Body body = theatre::humanBody(1.7);
    cast.actors = {{body.stature, {}}};
    for (int frame = 0; frame < 8; ++frame)
        cast.actors[0].poses.push_back(
            theatre::poseOf(body, body.restPose({0, body.joints[0].offset.y, 2}, theatre::rotationOf({0, 0.78 * frame, 0}))));
    cast.stage.platforms.push_back({"step", {-1.2, 0.2, 1}, {0.6, 0.4, 0.6}, 0.4});
    theatre::Stage::Platform box;
    box.size = {0.3, 0.3, 0.3};
    cast.stage.props.push_back({"box",
                                {},
                                std::make_shared<const theatre::Prop::Shape>(meshOf(box)),
                                theatre::Prop::Holder{0, theatre::BodyPart::LeftHand}});
    render::ShadowSource source;
    source.lamps = {{cast.stage.beams[0].light, 0, {1, 0.9f, 0.7f}, {0, 0, 0.05f}, {}}};
    source.cast = std::make_shared<const theatre::Cast>(std::move(cast));
    source.from = {-2, 0};
    source.to = {2, 2.25};
    source.play = render::ShadowSource::Play::Loop;
    return source;
}

// The same in soft light from two sides.
render::ShadowSource softly(render::ShadowSource source) {
    source.samples = 3;
    source.lamps[0].size = 0.1;
    source.lamps[0].actors = {{0.4f, 0, 0}};
    source.lamps.push_back({{-2, 1, 6}, 0, {0, 0, 0.5f}, {}, {}});
    return source;
}

}  // namespace

ThreeOutputs::ThreeOutputs(const std::array<std::string, 3>& displays)
    : site(siteIn(folder, displays)),
      camera(std::make_shared<render::PictureFeed>(glm::ivec2(64, 36))),
      seen(64, 36, {200, 150, 100, 255}) {
    const render::PatternSource pattern = render::moving(render::smallPattern());
    render::FoliageSource foliage{glm::vec3(1, 0.93f, 0.76f), glm::vec3(0.01f), {}};
    foliage.layers.push_back({pattern, {}});
    foliage.layers.push_back({pattern, {0.1, nullptr}});
    auto picture = std::make_shared<RgbaImage>(64, 36);
    for (int y = 0; y < picture->height(); ++y)
        for (int x = 0; x < picture->width(); ++x)
            picture->at(x, y) = {static_cast<std::uint8_t>(4 * x), static_cast<std::uint8_t>(7 * y), 90,
                                 static_cast<std::uint8_t>(x < 32 ? 255 : 128)};
    sources = render::PictureSources::numbered(
        {pattern, render::SolidSource{{0.2f, 0.05f, 0.3f}}, foliage,
         render::CausticsSource{glm::vec3(0.1f, 0.15f, 0.17f), {16.0 / 3, 3}, 1.2, 0.55, 0.02, 1},
         render::MirrorBallSource{glm::vec3(3), {16.0 / 3, 3}, {0, 0.5, 2.2}, 0.25, 0.03, {2.6, 1.8, 1}, 0.05, 60},
         render::ImageSource{picture}, render::VideoSource{videoIn(folder)}, render::CameraSource{camera}, turning(),
         softly(turning())});

    using show::Blend;
    constexpr Time kFade = std::chrono::milliseconds(40);
    constexpr std::array kBlends = {Blend::Add, Blend::Over, Blend::Multiply, Blend::Screen};
    const auto count = static_cast<std::uint32_t>(sources.size());
    cues.dark.outputs.resize(site.outputs.size());
    for (std::uint32_t cue = 0; cue < count; ++cue) {
        show::Look look = cues.dark;
        for (std::uint32_t output = 0; output < look.outputs.size(); ++output)
            for (std::uint32_t layer = 0; layer < 3; ++layer)
                look.outputs[output].layers.push_back(
                    {(cue + output + layer * 2) % count, 0.8f, layer == 0 ? Blend::Add : kBlends[(cue + layer) % 4]});
        // A look whose layers do more than add is composed as a picture of its own.
        for (show::OutputState& state : look.outputs) state.pictures = {{0, 3, 1}};
        cues.cues.push_back({look, kFade, std::nullopt});
    }
    // Shapes over a colour, a picture and both, none of which moves.
    const std::uint32_t resting = count;
    sources.add({count}, render::resting(render::smallPattern()));
    show::Look look = cues.dark;
    look.outputs[0].layers = {{1, 1.0f}, {resting, 0.9f, Blend::Over}};
    look.outputs[1].layers = {{5, 1.0f}, {resting, 0.7f, Blend::Screen}};
    look.outputs[2].layers = {{resting, 1.0f}, {5, 1.0f, Blend::Over}};
    for (show::OutputState& state : look.outputs) state.pictures = {{0, 2, 1}};
    still = static_cast<int>(cues.cues.size());
    cues.cues.push_back({look, kFade, std::nullopt});
}

}  // namespace fantascope::app
