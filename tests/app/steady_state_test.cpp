// What a frame of a running show may not do, held by counting it: three outputs, every kind of
// source, every blend.
//
// The steps of the frame loop run here with llvmpipe's rasteriser on the render thread, so that a
// wait for another thread of OpenGL's does not hide one of ours, and on a clock that is moved by
// whoever sleeps on it: what waits then waits for something else than a refresh. Not held: what a
// graphics card's driver does, what the X server does with a window, and C libraries' use of malloc
// (`new` alone is seen).

#include "app/live/frame_loop.h"
#include "app/three_outputs.h"
#include "drivers/site/world.h"

#include "allocations.h"
#include "gl_calls.h"
#include "source_folder.h"
#include "system_calls.h"

#include <gmock/gmock.h>
#include <stdlib.h>

#include <fstream>
#include <thread>

namespace fantascope::app {
namespace {

// Before OpenGL is loaded.
const bool rasterisesOnTheCallingThread = ::setenv("LP_NUM_THREADS", "0", 1) == 0;

struct Counts {
    std::int64_t allocations = 0, programs = 0, objects = 0, compilations = 0, files = 0, waits = 0;
    friend bool operator==(const Counts&, const Counts&) = default;
    friend void PrintTo(const Counts& counts, std::ostream* out) {
        *out << counts.allocations << " allocations, " << counts.programs << " programs, " << counts.objects << " GL objects, "
             << counts.compilations << " compilations, " << counts.files << " files opened, " << counts.waits << " waits";
    }
};

class SteadyState : public testing::Test {
protected:
    SteadyState() : show_({"{driver: headless}", "{driver: headless}", "{driver: headless}"}) {
        auto devices = openDevices(show_.site, Backends::SimulatedHeadless, {clock_, &world_});
        FANTASCOPE_CHECK(devices.has_value(), devices.error().message());
        devices_ = std::move(devices).value();
    }
    void prepare() {
        loop_.emplace(show_.site, inputs_, show_.sources, sourceFolder() + "/assets", devices_, clock_);
        const auto prepared = loop_->prepare();
        ASSERT_TRUE(prepared) << prepared.error().message();
        loop_->begin(show::ShowClock(clock_.now()));
        gl_.emplace();
    }
    static constexpr int kFrames = 5;  // of each cue; it fades for half of them
    // What the frames of a show do that enters every cue once.
    Counts lap() {
        Counts sum;
        for (int cue = 0; cue < static_cast<int>(show_.cues.cues.size()); ++cue) {
            inputs_.submit({clock_.now(), show::Input::Kind::Jump, cue});
            for (int frame = 0; frame < kFrames; ++frame) {
                const auto picture = std::make_shared<const RgbaImage>(show_.seen);
                show_.camera->publish(picture);
                const Counts before = now();
                loop_->step();
                const Counts after = now();
                // An input is remembered for the night, so that the frame that takes one may need
                // room for it.
                if (frame > 0) sum.allocations += after.allocations - before.allocations;
                sum.programs += after.programs - before.programs;
                sum.objects += after.objects - before.objects;
                sum.compilations += after.compilations - before.compilations;
                sum.files += after.files - before.files;
                sum.waits += after.waits - before.waits;
            }
        }
        return sum;
    }
    int framesOfLap() const { return kFrames * static_cast<int>(show_.cues.cues.size()); }
    Counts now() const {
        return {allocationsSoFar(), gl_->programs(), gl_->objects(), compilationsSoFar(), filesOpenedSoFar(), waitsSoFar()};
    }

    ThreeOutputs show_;
    show::InputLog inputs_{show_.cues};
    ManualClock clock_;
    site::World world_{clock_};
    Devices devices_;
    std::optional<GlCalls> gl_;
    std::optional<FrameLoop> loop_;
};

TEST_F(SteadyState, makes_nothing_opens_nothing_compiles_nothing_and_waits_for_nobody) {
    prepare();
    const Counts first = lap();
    EXPECT_EQ(first.programs, 0);
    EXPECT_EQ(first.objects, 0);
    EXPECT_EQ(first.files, 0);
    EXPECT_EQ(first.compilations, 0);
    // Once every cue was there, its vectors have their room, too.
    EXPECT_EQ(lap(), Counts{});
    for (const OutputReport& output : loop_->outputs()) EXPECT_EQ(output.frames, 2 * framesOfLap());
}

// A projector that is switched on in the middle of the show holds up nobody.
TEST_F(SteadyState, is_kept_when_an_output_comes_that_was_absent_at_the_start) {
    world_.setPlugged("left", false);
    prepare();
    lap();
    EXPECT_EQ(loop_->outputs()[0].frames, 0);
    world_.setPlugged("left", true);
    Counts first = lap();
    first.allocations = 0;  // what its layers need, once
    EXPECT_EQ(first, Counts{});
    EXPECT_EQ(loop_->outputs()[0].frames, framesOfLap());
    EXPECT_EQ(loop_->outputs()[1].frames, 2 * framesOfLap());
    EXPECT_EQ(lap(), Counts{});
}

// The counters themselves: what they are to find does not pass them by.
TEST_F(SteadyState, is_not_said_of_a_loop_that_was_not_prepared) {
    prepare();
    loop_.reset();
    const Counts before = now();
    loop_.emplace(show_.site, inputs_, show_.sources, sourceFolder() + "/assets", devices_, clock_);
    ASSERT_TRUE(loop_->prepare());
    std::jthread([] {}).join();
    const Counts after = now();
    EXPECT_GT(after.allocations, before.allocations);
    EXPECT_GT(after.programs, before.programs);
    EXPECT_GT(after.objects, before.objects);
    EXPECT_GT(after.files, before.files);
    EXPECT_GT(after.compilations, before.compilations);
    std::jthread waitedFor([clock = SteadyClock()]() mutable { clock.sleepUntil(clock.now() + std::chrono::milliseconds(20)); });
    waitedFor.join();
    EXPECT_GT(now().waits, after.waits);
}

}  // namespace
}  // namespace fantascope::app
