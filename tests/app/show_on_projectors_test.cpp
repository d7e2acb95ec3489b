// The show on a real X server with three projectors: what each of them is sent, read back from the
// screen, while somebody switches one off and on and changes two cables over.

#include "app/live/frame_loop.h"
#include "app/three_outputs.h"

#include "render/golden.h"

#include "contract/eventually.h"
#include "contract/projectors.h"
#include "core/check.h"
#include "edid_block.h"
#include "running_program.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>

namespace fantascope::app {
namespace {

using Frames = std::array<std::int64_t, 3>;

class ShowOnProjectors : public testing::Test {
protected:
    // Projectors of these serial numbers on DUMMY0 to DUMMY2, side by side, and the show on them.
    void SetUp() override {
        auto projectors = Projectors::start();
        ASSERT_TRUE(projectors) << projectors.error().message();
        projectors_ = std::move(projectors).value();
        for (int i = 0; i < 3; ++i) {
            projectors_->switchOn(connector(i), {i * ThreeOutputs::kSize.x, 0});
            projectors_->plug(connector(i), edidOf(i));
        }
        show_.emplace(std::array<std::string, 3>{"{driver: glfw, monitor: {serial: A}}", "{driver: glfw, monitor: {serial: B}}",
                                                 "{driver: glfw, monitor: {serial: C}}"});
        show_->camera->publish(std::make_shared<const RgbaImage>(show_->seen));
    }
    // What the site asks for is there now, or comes later.
    void begin() {
        auto devices = openDevices(show_->site, Backends::AsDeclared, {clock_});
        ASSERT_TRUE(devices) << devices.error().message();
        devices_ = std::move(devices).value();
        inputs_.emplace(show_->cues);
        loop_.emplace(show_->site, *inputs_, show_->sources, sourceFolder() + "/assets", devices_, clock_);
        const auto prepared = loop_->prepare();
        ASSERT_TRUE(prepared) << prepared.error().message();
        loop_->begin(show::ShowClock(clock_.now()));
    }
    void TearDown() override {
        loop_.reset();
        devices_ = {};
        show_.reset();
    }

    static std::string connector(int number) { return fmt::format("DUMMY{}", number); }
    static std::vector<std::uint8_t> edidOf(int projector) {
        return edidBlock({.serial = std::string(1, static_cast<char>('A' + projector))});
    }
    void frame() { loop_->step(); }
    // Frames until it is so; what happens to a projector travels by the X server. An absurd number
    // of frames: it will never be.
    bool framesUntil(const std::function<bool()>& so) {
        for (int frames = 0; frames < 5'000 && !so(); ++frames) frame();
        return so();
    }
    bool runs(std::size_t output) const { return devices_.displays[output]->status().state == DeviceState::Running; }
    // Enters a cue and lets its fade pass.
    void enter(int cue) {
        inputs_->submit({clock_.now(), show::Input::Kind::Jump, cue});
        for (int frames = 0; frames < 10; ++frames) frame();
    }
    Frames frames() const {
        Frames frames{};
        for (std::size_t i = 0; i < 3; ++i) frames[i] = loop_->outputs()[i].frames;
        return frames;
    }
    // What a projector throws: its part of the screen.
    RgbaImage thrownBy(const std::string& connector) const {
        const auto picture = projectors_->picture(connector);
        FANTASCOPE_CHECK(picture && picture->size == ThreeOutputs::kSize, connector + " shows another picture");
        const auto rows = projectors_->server().rows();
        RgbaImage image(picture->size.x, picture->size.y);
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x) {
                const auto [red, green, blue] = rows[std::size_t(picture->corner.y + y)][std::size_t(picture->corner.x + x)];
                image.at(x, y) = {red, green, blue, 255};
            }
        return image;
    }
    // Every projector throws the picture of its output, whatever connector it hangs on. Nothing in
    // the cue moves, since how many frames it takes until the X server has told of a cable is
    // nobody's to say.
    void expectGolden(const std::array<int, 3>& connectors) {
        frame();
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_TRUE(
                looksLikeGolden(fmt::format("projector-{}", ThreeOutputs::kNames[i]), thrownBy(connector(connectors[i]))));
    }

    std::unique_ptr<Projectors> projectors_;
    std::optional<ThreeOutputs> show_;
    std::optional<show::InputLog> inputs_;
    ManualClock clock_;
    Devices devices_;
    std::optional<FrameLoop> loop_;
};

TEST_F(ShowOnProjectors, looks_golden_on_each_while_they_come_and_go_and_change_places) {
    begin();
    enter(show_->still);
    expectGolden({0, 1, 2});

    // The middle one, then the one that leads.
    for (const int lost : {1, 0}) {
        projectors_->switchOff(connector(lost));
        ASSERT_TRUE(framesUntil([&] { return !runs(std::size_t(lost)); }));
        const Frames before = frames();
        for (int count = 0; count < 20; ++count) frame();
        Frames expected = before;
        for (std::size_t i = 0; i < 3; ++i) expected[i] += std::size_t(lost) == i ? 0 : 20;
        EXPECT_EQ(frames(), expected) << "without output " << lost;
        projectors_->switchOn(connector(lost), {0, 300}, Projectors::kLarge);
        ASSERT_TRUE(framesUntil([&] { return runs(std::size_t(lost)); }));
        expectGolden({0, 1, 2});
    }

    projectors_->plug(connector(0), {});
    ASSERT_TRUE(framesUntil([&] { return !runs(0); }));
    projectors_->plug(connector(2), edidOf(0));
    ASSERT_TRUE(framesUntil([&] { return runs(0) && !runs(2); }));
    projectors_->plug(connector(0), edidOf(2));
    ASSERT_TRUE(framesUntil([&] { return runs(2); }));
    expectGolden({2, 1, 0});
    EXPECT_EQ(devices_.displays[1]->status().losses, 1) << "it was switched off once";
    EXPECT_EQ(loop_->framesLate(), 0) << "who is away is late for nothing, and nobody waited for them";
}

// Example failure: the program ends with the X server; or it goes on, and the wall stays dark.
TEST_F(ShowOnProjectors, looks_golden_again_on_the_next_x_server) {
    begin();
    enter(show_->still);
    expectGolden({0, 1, 2});
    projectors_->crash();
    frame();
    ASSERT_TRUE(!runs(0) && !runs(1) && !runs(2));
    const Frames before = frames();
    const Time lost = clock_.now();
    for (int count = 0; count < 120; ++count) frame();
    EXPECT_EQ(frames(), before) << "nobody sees anything";
    EXPECT_GT(clock_.now(), lost + std::chrono::seconds(1)) << "the show goes on";
    projectors_->startAgain();
    for (int i = 0; i < 3; ++i) {
        projectors_->switchOn(connector(i), {i * ThreeOutputs::kSize.x, 0});
        projectors_->plug(connector(i), edidOf(i));
    }
    contract::eventually("all are back", [&] {  // without a picture a frame takes no time, and what finds them has its own
        frame();
        return runs(0) && runs(1) && runs(2);
    });
    expectGolden({0, 1, 2});
    EXPECT_EQ(loop_->framesLate(), 0);
}

// Its pictures were made before it came.
TEST_F(ShowOnProjectors, joins_when_a_projector_comes_that_was_absent_at_the_start) {
    projectors_->plug(connector(1), {});
    begin();
    enter(show_->still);
    const Frames before = frames();
    EXPECT_EQ(before[1], 0);
    projectors_->plug(connector(1), edidOf(1));
    ASSERT_TRUE(framesUntil([&] { return runs(1); }));
    expectGolden({0, 1, 2});
    EXPECT_EQ(loop_->framesLate(), 0);
}

TEST_F(ShowOnProjectors, plays_every_kind_of_source_in_every_blend_at_once) {
    begin();
    for (int cue = 0; cue < static_cast<int>(show_->cues.cues.size()); ++cue) enter(cue);
    const Frames shown = frames();
    EXPECT_EQ(shown[1], shown[0]);
    EXPECT_EQ(shown[2], shown[0]);
    EXPECT_EQ(loop_->framesLate(), 0);
    EXPECT_EQ(loop_->swapSkew().count(), static_cast<std::uint64_t>(shown[0]));
}

// The night itself, on windows of an X server that crashes, and once more without one at the start.
class NightOnAnXServer : public testing::Test {
protected:
    NightOnAnXServer() {
        (void)folder_.file("site.yaml", R"(fantascope: site
version: 1
outputs:
  - {name: left, display: {driver: glfw}, size: [64, 36], refresh_rate: 30}
  - {name: right, display: {driver: glfw}, size: [64, 36], refresh_rate: 30}
)");
        (void)folder_.file("show.yaml", R"(fantascope: show
version: 1
title: Two colours
sources: {red: {solid: [1, 0, 0]}, blue: {solid: [0, 0, 1]}}
looks: {both: {outputs: {left: [{source: red}], right: [{source: blue}]}}}
cues: [{name: Both, look: both, fade: 0.1}]
)");
    }
    RunningProgram night() const {
        return {{"run", "show.yaml", "--site", "site.yaml", "--from", "Both", "--report", "report.json"}, folder_.path()};
    }
    // Returns once both windows show their colours.
    static void see(const XServer& server) {
        using Pixel = std::array<std::uint8_t, 3>;
        contract::eventually("both windows are seen", [&] {
            const auto row = server.row(10);
            return std::ranges::count(row, Pixel{255, 0, 0}) == 64 && std::ranges::count(row, Pixel{0, 0, 255}) == 64;
        });
    }
    static bool says(RunningProgram& night, const std::string& what) {
        for (int lines = 0; lines < 60; ++lines) {
            const auto line = night.line();
            if (!line) return false;
            if (line->find(what) != std::string::npos) return true;
        }
        return false;
    }

    const ScratchFolder folder_;
};

TEST_F(NightOnAnXServer, outlives_it_and_ends_well_when_asked_to) {
    auto server = XServer::start();
    ASSERT_TRUE(server) << server.error().message();
    RunningProgram night = this->night();
    see(**server);
    for (const bool killed : {true, false}) {
        if (killed)
            (*server)->crash();
        else
            (*server)->killProgramOf("left");
        ASSERT_TRUE(says(night, "the X server has ended")) << night.all();
        if (killed) (*server)->startAgain();
        ASSERT_TRUE(says(night, "is back")) << night.all();
        see(**server);
    }
    (*server)->crash();
    ASSERT_TRUE(says(night, "the X server has ended")) << night.all();
    EXPECT_EQ(night.stop(SIGTERM), 0) << night.all();
    EXPECT_TRUE(std::filesystem::exists(folder_ / "report.json"));
}

// Its unit and the X server's may start in any order.
TEST_F(NightOnAnXServer, may_begin_before_it) {
    auto server = XServer::start();
    ASSERT_TRUE(server) << server.error().message();
    (*server)->crash();
    RunningProgram night = this->night();
    ASSERT_TRUE(says(night, "start an X server")) << night.all();
    (*server)->startAgain();
    see(**server);
    EXPECT_EQ(night.stop(SIGTERM), 0) << night.all();
}

}  // namespace
}  // namespace fantascope::app
