#include "app/live/frame_loop.h"

#include "app/passing_display.h"
#include "app/running_show.h"

#include "pattern/motion/pattern_motion.h"
#include "pattern/shape/elemental_shape.h"

#include "scratch_folder.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;

// A display whose drawing takes time: the clock moves on while it is made current to be drawn.
class SlowDisplay final : public PassingDisplay {
public:
    SlowDisplay(std::unique_ptr<DisplaySink> display, ManualClock& clock) : PassingDisplay(std::move(display)), clock_(clock) {}
    Time nextTakes{}, completionTakes{}, swapTakes{};  // of the next frame: drawing, its completion, swapping
    Time swapsAfter{};                                 // its refreshes' moments
    std::function<void()> meanwhile;                   // while it swaps
    std::function<void()> asItFinishes;                // after the drawing

    Result<void> makeCurrent() override {
        clock_.advance(std::exchange(nextTakes, Time{}));
        return display_->makeCurrent();
    }
    Result<void> finish() override {
        clock_.advance(std::exchange(completionTakes, Time{}));
        if (asItFinishes) asItFinishes();
        return display_->finish();
    }
    Result<Shown> present() override {
        return swapped([&] { return display_->present(); });
    }
    Result<Shown> presentWith(Time leading) override {
        return swapped([&] { return display_->presentWith(leading); });
    }

private:
    Result<Shown> swapped(auto present) {
        const Time took = std::exchange(swapTakes, Time{});
        clock_.advance(took);
        if (meanwhile) meanwhile();
        auto shown = present();
        if (shown) {
            shown->swap = took;
            shown->swapped += swapsAfter;
        }
        return shown;
    }
    ManualClock& clock_;
};

class FrameLoopPart : public testing::Test {
protected:
    FrameLoopPart() {
        auto slow = std::make_unique<SlowDisplay>(std::move(run_.devices.displays[0]), run_.clock);
        left_ = slow.get();
        run_.devices.displays[0] = std::move(slow);
        const auto sources = render::PictureSources::numbered({run_.show.sources.size(), render::SolidSource{}});
        loop_.emplace(run_.site, run_.inputs, sources, sourceFolder() + "/assets", run_.devices, run_.clock);
        for (std::size_t output = 0; output < 2; ++output) readers_.push_back(&loop_->tap(output).addQueue());
        EXPECT_TRUE(loop_->prepare());
        loop_->begin(show::ShowClock(run_.clock.now()));
    }
    // Then finished frames wait for inputs.
    void warmUp() { step(35); }
    void step(int frames = 1) {
        for (int frame = 0; frame < frames; ++frame) {
            loop_->step();
        }
    }
    // A frame whose drawing takes so many refreshes.
    void slowStep(double refreshes) {
        left_->nextTakes = fromSeconds(refreshes / 30);
        step();
    }
    // The refreshes of the frames that an output has shown so far, since the last call.
    std::vector<std::int64_t> shownOn(std::size_t output) {
        std::vector<std::int64_t> refreshes;
        while (const render::ShownFrame* const frame = readers_[output]->next(Time::max()))
            refreshes.push_back(frame->shown.refresh);
        return refreshes;
    }

    RunningShow run_;
    SlowDisplay* left_;
    std::optional<FrameLoop> loop_;
    std::vector<render::FrameReader*> readers_;
};

// Example failure: lateness counts from the show's beginning, and a show that was resumed after
// three hours was late all that time.
TEST_F(FrameLoopPart, of_a_show_resumed_after_three_hours_counts_none_of_them_as_late) {
    LatestValue<show::ShowState> shown;
    loop_->publishStateTo(shown);
    run_.inputs.submit({3h - 1s, show::Input::Kind::Jump, 0});  // before this run
    const Time start = run_.clock.now();
    loop_->begin(show::ShowClock(start, 3h));
    step(10);
    slowStep(4.5);
    run_.inputs.submit({3h + (run_.clock.now() - start), show::Input::Kind::Jump, 1});
    step(10);
    EXPECT_EQ(loop_->framesLate(), 6);
    shown.update();
    EXPECT_EQ(shown.value().cue, 1);
    EXPECT_EQ(loop_->inputToFrame().count(), 1u);
    EXPECT_LT(loop_->inputToFrame().maxMs(), 100);
    loop_->finish(run_.clock.now());
    EXPECT_EQ(loop_->framesLate(), 6);
}
TEST_F(FrameLoopPart, of_a_resumed_show_is_late_where_no_frame_came_at_all) {
    loop_->begin(show::ShowClock(run_.clock.now(), 3h));
    run_.clock.advance(1s);
    loop_->finish(run_.clock.now());
    EXPECT_EQ(loop_->framesLate(), 60) << "a second of both outputs, and no hours";
}

TEST_F(FrameLoopPart, shows_every_refresh_once_on_every_output) {
    for (std::int64_t refresh = 1; refresh <= 10; ++refresh) {
        step();
        for (std::size_t output = 0; output < 2; ++output) EXPECT_THAT(shownOn(output), testing::ElementsAre(refresh)) << output;
    }
    EXPECT_EQ(loop_->framesShown(), 20);
    EXPECT_EQ(loop_->framesLate(), 0);
}

// The machine is taken away while a finished frame waits for its refresh: the next one is for the
// refresh after.
TEST_F(FrameLoopPart, a_gap_of_more_than_a_period_does_not_show) {
    warmUp();
    for (int gap = 0; gap < 3; ++gap) {
        step(5);
        slowStep(1.3);
    }
    slowStep(0.9);  // the lead is used up
    step(5);
    EXPECT_EQ(loop_->framesLate(), 0);
}

// A machine that is busy now may be so again.
TEST_F(FrameLoopPart, a_gap_of_almost_two_periods_shows_twice_in_a_while) {
    warmUp();
    const auto gaps = [&](int count) {
        for (int gap = 0; gap < count; ++gap) {
            step(5);
            run_.clock.advance(fromSeconds(1.9 / 30));
        }
        step();
    };
    gaps(2);
    EXPECT_EQ(loop_->framesLate(), 4) << "two on each output";
    gaps(3);
    EXPECT_EQ(loop_->framesLate(), 4) << "the loop draws ahead";
    step(200);
    gaps(1);
    EXPECT_EQ(loop_->framesLate(), 6) << "not for ever";
}

// Example failure: a frame that is three refreshes late counts as one.
TEST_F(FrameLoopPart, every_missed_refresh_counts_on_every_output) {
    step(5);
    slowStep(4.5);  // of two that it had
    EXPECT_EQ(loop_->outputs()[0].lateFrames(), 3);
    EXPECT_EQ(loop_->outputs()[1].lateFrames(), 3);
    EXPECT_EQ(loop_->framesLate(), 6);
    step(5);
    EXPECT_EQ(loop_->framesLate(), 6) << "what comes after is in time again";
}

// Example failure: what happens between two frames is nobody's fault, since the next frame aims at
// what can still be met.
TEST_F(FrameLoopPart, refreshes_that_no_frame_was_for_count_too) {
    run_.clock.advance(fromSeconds(2.0 / 30));
    step();
    EXPECT_EQ(loop_->outputs()[0].lateFrames(), 2) << "before the first frame";
    step(5);
    run_.clock.advance(fromSeconds(3.0 / 30));
    step(5);
    EXPECT_EQ(loop_->outputs()[0].lateFrames(), 4) << "of three one was covered by the frame in hand";
    EXPECT_EQ(loop_->outputs()[1].lateFrames(), 4);
}

// Example failure: a run whose last frames took too long reports fewer refreshes than it lasted,
// and nobody missed any.
TEST_F(FrameLoopPart, refreshes_before_the_end_that_no_frame_was_for_count_too) {
    step(5);
    run_.clock.advance(fromSeconds(3.5 / 30));
    loop_->finish(run_.clock.now());
    EXPECT_EQ(loop_->outputs()[0].lateFrames(), 2) << "of three one was covered by the frame in hand";
    EXPECT_EQ(loop_->outputs()[1].lateFrames(), 2);
    loop_->finish(run_.clock.now());
    EXPECT_EQ(loop_->framesLate(), 4) << "counted once";
}

// What kept the thread on the one output made the other one late, too.
// Example failure: the wait for a refresh counts as a long swap, so that every late frame is its.
TEST_F(FrameLoopPart, late_frames_are_told_apart_by_what_made_them_late) {
    constexpr std::size_t kRender = 1, kSwap = 2, kMachine = 3;
    const Time long_ = fromSeconds(4.5 / 30);
    const std::array<std::pair<std::function<void()>, std::size_t>, 4> cases = {
        {{[&] { left_->nextTakes = long_; }, kRender},
         {[&] { left_->completionTakes = long_; }, kRender},
         {[&] { left_->swapTakes = long_; }, kSwap},
         {[&] { run_.clock.advance(long_); }, kMachine}}};
    std::array<std::int64_t, 4> expected{};
    for (const auto& [delay, cause] : cases) {
        step(5);
        const std::int64_t before = loop_->framesLate();
        delay();
        step(5);
        const std::int64_t late = loop_->framesLate() - before;
        EXPECT_GE(late, 2 * 2) << "cause " << cause;
        expected[cause] += late;
    }
    std::array<std::int64_t, 4> seen{};
    for (const OutputReport& output : loop_->outputs()) {
        for (std::size_t part = 0; part < kFrameParts; ++part) seen[part] += output.lateBy[part];
        seen[kMachine] += output.lateByMachine;
    }
    EXPECT_EQ(seen, expected);
    EXPECT_EQ(lateFramesByCause(loop_->outputs()),
              fmt::format("{} render, {} swap, {} machine", expected[kRender], expected[kSwap], expected[kMachine]));
}

TEST_F(FrameLoopPart, measures_the_parts_of_each_outputs_frames) {
    step(5);
    left_->nextTakes = 7ms, left_->completionTakes = 5ms, left_->swapTakes = 3ms;
    step();
    const auto mostMs = [&](std::size_t output, FramePart part) {
        return loop_->outputs()[output].took[static_cast<std::size_t>(part)].maxMs();
    };
    EXPECT_EQ(mostMs(0, FramePart::Render), 12);
    EXPECT_EQ(mostMs(0, FramePart::Swap), 3);
    EXPECT_EQ(mostMs(1, FramePart::Render), 0);
    EXPECT_EQ(mostMs(1, FramePart::Swap), 0);
    EXPECT_EQ(loop_->outputs()[0].took[0].count(), 6u);
    EXPECT_EQ(loop_->framesLate(), 0);
}

TEST_F(FrameLoopPart, measures_how_far_the_outputs_swaps_are_apart) {
    step(5);
    EXPECT_EQ(loop_->swapSkew().count(), 5u);
    EXPECT_EQ(loop_->swapSkew().maxMs(), 0);
    left_->swapsAfter = 2ms;
    step();
    EXPECT_EQ(loop_->swapSkew().maxMs(), 2);
    run_.world.setPlugged("right", false);
    step(5);
    EXPECT_EQ(loop_->swapSkew().count(), 6u) << "one output alone has nothing to be apart from";
}

TEST(FrameDelays, are_the_machines_where_the_thread_had_time) {
    EXPECT_EQ(causeOfDelay({1ms, 20ms, 3ms}, 30ms), std::nullopt);
    EXPECT_EQ(causeOfDelay({11ms, 12ms, 13ms}, 30ms), FramePart::Swap) << "none of them alone";
    EXPECT_EQ(causeOfDelay({31ms, 0ms, 0ms}, 30ms), FramePart::Upload);
}

// A clock on which each look takes a microsecond.
class TickingClock final : public Clock {
public:
    explicit TickingClock(ManualClock& clock) : clock_(clock) {}
    Time now() const override {
        clock_.advance(1us);
        return clock_.now();
    }
    void sleepUntil(Time time) override { clock_.sleepUntil(time); }

private:
    ManualClock& clock_;
};

// Example failure: warming up counts, or what one output uploads is the other's.
TEST(FrameUploads, are_told_apart_from_drawing) {
    RunningShow run;
    TickingClock clock(run.clock);
    const auto pattern = std::make_shared<const pattern::ShapePattern>([] {
        pattern::ShapePattern square;
        square.width = 16, square.height = 9;
        square.shapes.push_back(valueOf(pattern::loadShape("square")));
        square.instances.resize(1);
        return square;
    }());
    show::CueList cues = run.cues;
    cues.cues.resize(1);
    cues.cues[0].fade = Time{};
    cues.cues[0].look.outputs[0].layers = {{0, 1.0f}};
    cues.cues[0].look.outputs[1].layers = {{1, 1.0f}};
    show::InputLog inputs(cues);
    FrameLoop loop(run.site, inputs,
                   render::PictureSources::numbered({render::PatternSource{pattern, nullptr}, render::SolidSource{}}),
                   sourceFolder() + "/assets", run.devices, clock);
    ASSERT_TRUE(loop.prepare());
    loop.begin(show::ShowClock(run.clock.now()));
    inputs.submit({Time{}, show::Input::Kind::Go});
    for (int frame = 0; frame < 5; ++frame) loop.step();
    constexpr auto kUpload = static_cast<std::size_t>(FramePart::Upload);
    EXPECT_EQ(loop.outputs()[0].took[kUpload].maxMs(), 1e-3);
    EXPECT_EQ(loop.outputs()[1].took[kUpload].maxMs(), 0);
}

TEST_F(FrameLoopPart, a_frame_in_hand_covers_the_end) {
    step(5);
    run_.clock.advance(fromSeconds(1.0 / 30));
    loop_->finish(run_.clock.now());
    EXPECT_EQ(loop_->framesLate(), 0);
}

// Example failure: a display that takes the lead shows a second frame for the refresh that another
// one has its frame for.
TEST_F(FrameLoopPart, the_lead_changes_hands_without_a_frame_too_many_or_too_few) {
    std::vector<std::int64_t> left, right;
    const auto stepAndRead = [&](int frames) {
        for (int frame = 0; frame < frames; ++frame) {
            step();
            for (const std::int64_t refresh : shownOn(0)) left.push_back(refresh);
            for (const std::int64_t refresh : shownOn(1)) right.push_back(refresh);
        }
    };
    stepAndRead(5);
    run_.world.setPlugged("left", false);
    stepAndRead(5);
    run_.world.setPlugged("left", true);
    stepAndRead(5);
    EXPECT_THAT(right, testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
    EXPECT_THAT(left, testing::ElementsAre(1, 2, 3, 4, 5, 11, 12, 13, 14, 15));
    EXPECT_EQ(loop_->framesLate(), 0);
}

TEST_F(FrameLoopPart, the_show_goes_on_in_time_toldevery_output_is_lost) {
    for (const char* output : {"left", "right"}) run_.world.setPlugged(output, false);
    const Time before = run_.clock.now();
    step(30);
    EXPECT_EQ(loop_->framesShown(), 0);
    EXPECT_NEAR(seconds(run_.clock.now() - before), 1, 0.04);
}

// The effect of a press is seen in the first frame that was drawn after it, not in the one that was
// finished already.
TEST_F(FrameLoopPart, measures_a_press_to_the_refresh_that_shows_it) {
    warmUp();
    step(5);
    const Time pressed = run_.clock.now();
    run_.inputs.submit({pressed, show::Input::Kind::Go});
    step(3);
    EXPECT_EQ(loop_->inputToFrame().count(), 1u);
    EXPECT_NEAR(loop_->inputToFrame().maxMs(), 1400.0 / 30, 0.01);
}

// Example failure: a frame that has been drawn goes to the display as it is, and a press is seen
// two refreshes later.
TEST_F(FrameLoopPart, draws_a_frame_again_for_a_press_that_comes_while_it_waits) {
    warmUp();
    step(5);
    for (std::size_t output = 0; output < 2; ++output) static_cast<void>(shownOn(output));
    left_->asItFinishes = [&] {
        run_.inputs.submit({run_.clock.now(), show::Input::Kind::Go});
        left_->asItFinishes = {};
    };
    step();
    ASSERT_EQ(loop_->inputToFrame().count(), 1u) << "it is seen in this frame";
    EXPECT_NEAR(loop_->inputToFrame().maxMs(), 1400.0 / 30, 0.01);
    EXPECT_EQ(loop_->framesLate(), 0);
    for (std::size_t output = 0; output < 2; ++output) EXPECT_THAT(shownOn(output), testing::SizeIs(1)) << "once";
    EXPECT_EQ(loop_->outputs()[0].took[0].count(), 41u);
}

TEST_F(FrameLoopPart, that_takes_long_to_draw_waits_for_no_press) {
    warmUp();
    step(5);
    for (int frame = 0; frame < 30; ++frame) slowStep(0.6);
    left_->nextTakes = fromSeconds(0.6 / 30);
    left_->asItFinishes = [&] {
        run_.inputs.submit({run_.clock.now(), show::Input::Kind::Go});
        left_->asItFinishes = {};
    };
    step();
    EXPECT_EQ(loop_->inputToFrame().count(), 0u);
    EXPECT_EQ(loop_->framesLate(), 0);
}

// Example failure: the wind of the one output blows on the other, or none arrives at all.
TEST(FrameLoopWind, each_output_sways_in_its_own) {
    pattern::ShapePattern square;
    square.width = 16, square.height = 9;
    square.motion.frames = 240;
    square.shapes.push_back(valueOf(pattern::loadShape("square")));
    pattern::ShapeInstance instance;
    instance.centre = {0.9, 0.5};
    instance.size = 0.3;
    square.instances.push_back(instance);
    const auto pattern = std::make_shared<const pattern::ShapePattern>(square);
    const render::PatternSource source{pattern, std::make_shared<const pattern::PatternMotion>(square)};

    RunningShow run;
    show::CueList cues = run.cues;
    cues.cues.resize(1);
    for (show::OutputState& output : cues.cues[0].look.outputs) output.layers = {{0, 1.0f}};
    cues.cues[0].fade = Time{};
    cues.cues[0].winds = {{.strength = 0}, {.strength = 4}};
    show::InputLog inputs(cues);
    FrameLoop loop(run.site, inputs, render::PictureSources::numbered({source}), sourceFolder() + "/assets", run.devices,
                   run.clock);
    const std::array<render::FrameReader*, 2> readers{&loop.tap(0).addQueue(), &loop.tap(1).addQueue()};
    ASSERT_TRUE(loop.prepare());
    loop.begin(show::ShowClock(run.clock.now()));
    inputs.submit({run.clock.now(), show::Input::Kind::Go});
    std::array<RgbaImage, 2> before;
    std::array<int, 2> changes{};
    for (int frame = 0; frame < 360; ++frame) {
        loop.step();
        for (std::size_t output = 0; output < 2; ++output)
            while (const render::ShownFrame* const shown = readers[output]->next(Time::max()))
                if (frame > 330 && std::exchange(before[output], shown->image) != shown->image) ++changes[output];
    }
    EXPECT_EQ(changes[0], 1) << "the first picture, and no other after it";
    EXPECT_GT(changes[1], 20);
}

// Example failure: the light jumps, or it fades by the show's time and not by the run's.
TEST(FrameLoopLight, its_correction_fades_in_from_the_runs_start) {
    RunningShow run;
    const auto sources = render::PictureSources::numbered({run.show.sources.size(), render::SolidSource{glm::vec3(1)}});
    const glm::ivec2 size = run.site.outputs[0].size();
    const auto gain = std::make_shared<const GreyImage>(size.x, size.y, 0.25f);
    FrameLoop loop(run.site, run.inputs, sources, sourceFolder() + "/assets", run.devices, run.clock, {gain, nullptr});
    const std::array<render::FrameReader*, 2> readers{&loop.tap(0).addQueue(), &loop.tap(1).addQueue()};
    ASSERT_TRUE(loop.prepare());
    run.inputs.submit({1h, show::Input::Kind::Jump, run.jumpTo("Both").cue});  // it is there when the run begins
    loop.begin(show::ShowClock(run.clock.now(), 2h));
    // The brightest light of an output, frame by frame.
    std::array<std::vector<float>, 2> light;
    for (Time until = run.clock.now() + FrameLoop::kLightFade + 500ms; run.clock.now() < until;) {
        loop.step();
        for (std::size_t output = 0; output < 2; ++output)
            while (const render::ShownFrame* const shown = readers[output]->next(Time::max())) {
                std::uint8_t most = 0;
                for (const Rgba8 pixel : shown->image.pixels()) most = std::max(most, pixel.g);
                light[output].push_back(linearFromSrgb(static_cast<float>(most) / 255));
            }
    }
    EXPECT_GT(light[0].front(), 0.98);
    EXPECT_NEAR(light[0].back(), 0.25, 0.01);
    for (std::size_t i = 1; i < light[0].size(); ++i) ASSERT_LT(light[0][i - 1] - light[0][i], 0.02) << i;
    EXPECT_EQ(light[1].front(), light[1].back());
}

// Somebody sets a mesh while the show runs, and no renderer can be made for it: what was on the
// wall stays there.
TEST(FrameLoop, keeps_its_renderer_where_a_new_one_cannot_be_made) {
    const ScratchFolder folder;
    std::filesystem::create_directories(folder / "assets");
    std::filesystem::copy(sourceFolder() + "/assets/shaders", folder / "assets/shaders",
                          std::filesystem::copy_options::recursive);
    RunningShow run;
    const auto sources = render::PictureSources::numbered({run.show.sources.size(), render::SolidSource{}});
    FrameLoop loop(run.site, run.inputs, sources, folder / "assets", run.devices, run.clock);
    render::FrameReader& reader = loop.tap(0).addQueue();
    ASSERT_TRUE(loop.prepare());
    loop.begin(show::ShowClock(run.clock.now(), 30s));  // the cue is faded in
    run.inputs.submit(run.jumpTo("Both"));
    const auto shown = [&] {
        loop.step();
        RgbaImage image;
        while (const render::ShownFrame* const frame = reader.next(Time::max())) image = frame->image;
        return image;
    };
    const RgbaImage before = shown();
    auto settings = std::make_shared<OutputSettings>();
    settings->projection = run.site.outputs[0].projection;
    WarpShape shape = settings->projection.warp.shape();
    shape.mesh = WarpMesh{WarpMesh::Between::Smooth, {2, 2}, {{9, 9}, {0, 0}, {0, 0}, {0, 0}}};
    settings->projection.warp = Warp::of(shape).value();
    const auto give = [&] {
        loop.settingsOf(0).writable() = settings;
        loop.settingsOf(0).publish();
    };
    std::filesystem::rename(folder / "assets/shaders/shape.frag", folder / "aside");
    give();
    const auto told = [&] { return loop.withFaults(run.devices.statuses())[0]; };
    EXPECT_EQ(told().trouble, "");
    EXPECT_EQ(shown(), before);
    EXPECT_EQ(shown(), before);
    EXPECT_EQ(told().state, DeviceState::Running);
    EXPECT_THAT(told().trouble,
                testing::AllOf(testing::StartsWith("it keeps its previous settings: "), testing::HasSubstr("shape.frag")));
    std::filesystem::rename(folder / "aside", folder / "assets/shaders/shape.frag");
    give();
    EXPECT_NE(shown(), before) << "and takes the next settings";
    EXPECT_EQ(told().trouble, "");
}

// A display whose context can be lost, as by the end of an X server; or that has none before it
// comes.
class MortalDisplay final : public PassingDisplay {
public:
    using Open = std::function<std::unique_ptr<DisplaySink>()>;
    explicit MortalDisplay(Open open) : PassingDisplay(nullptr), open_(std::move(open)) {}
    void die() {
        dead_ = std::move(display_);
        context_ = 0;
    }
    void live() {
        dead_.reset();
        display_ = open_();
        context_ = ++contexts_;
    }

    DeviceStatus status() const override {
        if (display_) return display_->status();
        return {"left", "mortal", DeviceState::Absent, LossAction::Dark, "it is dead", contexts_};
    }
    glm::ivec2 size() const override { return {640, 360}; }
    double refreshRate() const override { return 30; }
    // Nothing that was mapped is readable any longer than the contract says.
    bool poll() override {
        if (!dyingIsTold_ && dead_) return dyingIsTold_ = true, false;
        dead_.reset();
        dyingIsTold_ = false;
        return display_ && display_->poll();
    }
    int context() const override { return context_; }
    Result<void> makeCurrent() override { return display_ ? display_->makeCurrent() : Error("it is dead"); }

private:
    Open open_;
    std::unique_ptr<DisplaySink> dead_;
    int context_ = 0, contexts_ = 0;
    bool dyingIsTold_ = false;
};

// The left output hangs on a display that comes and goes with its context.
class FrameLoopFaults : public testing::Test {
protected:
    FrameLoopFaults() {
        std::filesystem::create_directories(folder_ / "assets");
        std::filesystem::copy(sourceFolder() + "/assets/shaders", folder_ / "assets/shaders",
                              std::filesystem::copy_options::recursive);
        auto mortal = std::make_unique<MortalDisplay>([this] {
            return std::move(valueOf(openDevices(run_.site, Backends::SimulatedHeadless, {run_.clock, &run_.world})).displays[0]);
        });
        left_ = mortal.get();
        run_.devices.displays[0] = std::move(mortal);
        const auto sources = render::PictureSources::numbered({run_.show.sources.size(), render::SolidSource{}});
        loop_.emplace(run_.site, run_.inputs, sources, folder_ / "assets", run_.devices, run_.clock);
        for (std::size_t output = 0; output < 2; ++output) readers_.push_back(&loop_->tap(output).addQueue());
    }
    void begin() {
        const auto prepared = loop_->prepare();
        ASSERT_TRUE(prepared) << prepared.error().message();
        loop_->begin(show::ShowClock(run_.clock.now(), 30s));  // the cue is faded in
        run_.inputs.submit(run_.jumpTo("Both"));
    }
    struct Seen {
        int frames = 0;
        RgbaImage last;
    };
    std::array<Seen, 2> step(int frames) {
        std::array<Seen, 2> seen;
        for (int frame = 0; frame < frames; ++frame) {
            loop_->step();
            for (std::size_t output = 0; output < 2; ++output)
                while (const render::ShownFrame* const shown = readers_[output]->next(Time::max())) {
                    ++seen[output].frames;
                    seen[output].last = shown->image;
                }
        }
        return seen;
    }
    // What the operator is told of the left output.
    DeviceStatus told() const { return loop_->withFaults(run_.devices.statuses())[0]; }
    void breakInstallation() const { std::filesystem::rename(shader_, folder_ / "aside"); }
    void mendInstallation() const { std::filesystem::rename(folder_ / "aside", shader_); }

    const ScratchFolder folder_;
    const std::filesystem::path shader_ = folder_ / "assets/shaders/compose.frag";
    RunningShow run_;
    MortalDisplay* left_ = nullptr;
    std::optional<FrameLoop> loop_;
    std::vector<render::FrameReader*> readers_;
};

// Example failure: the X server comes up after the program, a shader is missing by then, and the
// whole night ends.
TEST_F(FrameLoopFaults, an_output_that_cannot_be_drawn_leaves_the_others_alone_and_is_tried_again_with_back_off) {
    begin();
    EXPECT_EQ(step(5)[1].frames, 5);
    const std::int64_t late = loop_->framesLate();
    breakInstallation();
    left_->live();
    EXPECT_EQ(told().state, DeviceState::Running) << "nobody has tried yet";
    EXPECT_EQ(step(5)[1].frames, 5) << "the right output goes on";
    EXPECT_EQ(told().state, DeviceState::Faulted);
    EXPECT_THAT(told().detail,
                testing::AllOf(testing::HasSubstr("its picture cannot be drawn"), testing::HasSubstr("compose.frag")));
    EXPECT_EQ(left_->status().state, DeviceState::Running) << "the display itself is well";
    const auto beginning = run_.clock.now();
    while (run_.clock.now() < beginning + 20s) EXPECT_EQ(step(1)[1].frames, 1);
    mendInstallation();
    EXPECT_EQ(step(30)[0].frames, 0) << "after 1, 3, 7 and 15 seconds it waits until 31 are over";
    while (run_.clock.now() < beginning + 32s) step(1);
    EXPECT_EQ(told().state, DeviceState::Running);
    EXPECT_EQ(step(5)[0].frames, 5);
    EXPECT_EQ(loop_->framesLate(), late);
}

// Example failure: names of the lost context are deleted in another output's, whose picture breaks.
TEST_F(FrameLoopFaults, a_context_that_is_lost_takes_its_pictures_along_and_the_next_one_gets_its_own) {
    left_->live();
    begin();
    const std::array<Seen, 2> before = step(5);
    for (int time = 0; time < 3; ++time) {
        loop_->step();  // a frame that nobody has read yet
        left_->die();
        const std::array<Seen, 2> meanwhile = step(5);
        EXPECT_EQ(meanwhile[0].frames, 0) << "what was not read is lost with its memory";
        EXPECT_EQ(meanwhile[1].frames, 6);
        EXPECT_EQ(meanwhile[1].last, before[1].last);
        left_->live();
        const std::array<Seen, 2> after = step(5);
        EXPECT_EQ(after[0].frames, 5);
        EXPECT_EQ(after[0].last, before[0].last);
        EXPECT_EQ(after[1].last, before[1].last);
    }
}

// Somebody set the output up before its X server ended.
TEST_F(FrameLoopFaults, the_next_context_has_the_settings_of_the_lost_one) {
    left_->live();
    begin();
    const RgbaImage before = step(3)[0].last;
    auto settings = std::make_shared<OutputSettings>();
    settings->projection = run_.site.outputs[0].projection;
    settings->projection.light.brightness = 0.5;
    loop_->settingsOf(0).writable() = settings;
    loop_->settingsOf(0).publish();
    const RgbaImage set = step(3)[0].last;
    ASSERT_NE(set, before);
    left_->die();
    step(3);
    left_->live();
    EXPECT_EQ(step(3)[0].last, set);
}

TEST_F(FrameLoopFaults, an_installation_without_a_shader_is_told_before_the_show) {
    left_->live();
    breakInstallation();
    const auto prepared = loop_->prepare();
    ASSERT_FALSE(prepared);
    EXPECT_THAT(prepared.error().message(), testing::HasSubstr("compose.frag"));
}

// Example failure: nobody is told why the left wall is dark; or there is no show at all, for one
// output.
TEST(FrameLoop, begins_without_an_output_that_cannot_be_drawn) {
    RunningShow run;
    run.site.outputs[0].projection.size = {100'000, 100'000};
    const auto sources = render::PictureSources::numbered({run.show.sources.size(), render::SolidSource{}});
    FrameLoop loop(run.site, run.inputs, sources, sourceFolder() + "/assets", run.devices, run.clock);
    const auto prepared = loop.prepare();
    ASSERT_TRUE(prepared) << prepared.error().message();
    loop.begin(show::ShowClock(run.clock.now()));
    for (int frame = 0; frame < 5; ++frame) loop.step();
    const auto told = loop.withFaults(run.devices.statuses());
    EXPECT_EQ(told[0].state, DeviceState::Faulted);
    EXPECT_THAT(told[0].detail, testing::HasSubstr("100000 x 100000"));
    EXPECT_EQ(told[1].state, DeviceState::Running);
    EXPECT_EQ(loop.outputs()[1].frames, 5);
}

// An X server that hangs: the render thread waits in it, and somebody has to say so.
TEST_F(FrameLoopPart, tells_of_a_display_that_keeps_the_loop_waiting) {
    step(5);
    std::vector<DeviceStatus> told;
    left_->meanwhile = [&] { told = loop_->withFaults(run_.devices.statuses()); };
    left_->swapTakes = 10s;
    step();
    EXPECT_EQ(told[0].state, DeviceState::Faulted);
    EXPECT_THAT(told[0].detail, testing::HasSubstr("does not answer"));
    EXPECT_EQ(told[1].state, DeviceState::Running);
    EXPECT_EQ(loop_->withFaults(run_.devices.statuses())[0].state, DeviceState::Running) << "it goes on";
}

}  // namespace
}  // namespace fantascope::app
