// An output whose renderer is made while the others are shown, or can never be made.

#include "app/live/frame_loop.h"
#include "app/passing_display.h"
#include "app/running_show.h"

#include "source_folder.h"

#include <gmock/gmock.h>

#include <atomic>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;

// Each attempt to make something in this display's context takes 500 ms. On the render thread the
// clock moves on meanwhile; on another thread the attempt lasts until the clock was moved so far.
class ReluctantDisplay final : public PassingDisplay {
public:
    static constexpr Time kTakes = 500ms;
    enum class Attempt { Fails, Throws, Succeeds };

    ReluctantDisplay(std::unique_ptr<DisplaySink> display, ManualClock& clock)
        : PassingDisplay(std::move(display)), clock_(clock) {}
    std::atomic<Attempt> attempt = Attempt::Fails;
    std::atomic<int> attempts = 0;
    std::atomic<bool> patient = true;  // false: an attempt on another thread takes no time
    bool isLent() const { return lent_; }
    bool wasTouched() const { return touched_; }  // by the render thread while it was lent
    // Gives the other thread time to begin an attempt, or to end one, that is due by the clock.
    void awaitOther() const {
        while (released_ || (lent_ && clock_.now() >= end_.load())) std::this_thread::yield();
    }

    double refreshRate() const override { return touch(), display_->refreshRate(); }
    std::int64_t nextRefresh() const override { return touch(), display_->nextRefresh(); }
    Time refreshTime(std::int64_t number) const override { return touch(), display_->refreshTime(number); }
    bool poll() override { return touch(), display_->poll(); }
    int context() const override { return touch(), display_->context(); }
    Result<void> makeCurrent() override {
        touch();
        if (made_) return display_->makeCurrent();
        ++attempts;
        if (std::this_thread::get_id() == renderThread_) {
            clock_.advance(kTakes);
        } else {
            end_ = clock_.now() + kTakes;
            lent_ = true;
            released_ = false;
            while (patient && clock_.now() < end_.load()) std::this_thread::yield();
        }
        if (attempt == Attempt::Throws) throw std::runtime_error("the driver is out of order");
        if (attempt == Attempt::Fails) return Error("the graphics card is too small");
        made_ = true;
        return display_->makeCurrent();
    }
    void release() override {
        display_->release();
        (std::this_thread::get_id() == renderThread_ ? released_ : lent_) = std::this_thread::get_id() == renderThread_;
    }
    Result<Shown> present() override { return touch(), display_->present(); }
    Result<Shown> presentWith(Time leading) override { return touch(), display_->presentWith(leading); }

private:
    void touch() const {
        if (lent_ && std::this_thread::get_id() == renderThread_) touched_ = true;
    }
    ManualClock& clock_;
    const std::thread::id renderThread_ = std::this_thread::get_id();
    std::atomic<bool> made_ = false, lent_ = false, released_ = false;
    std::atomic<Time> end_{};  // of the attempt
    mutable std::atomic<bool> touched_ = false;
};

class MakingAside : public testing::Test {
protected:
    static constexpr std::size_t kReluctant = 0, kOther = 1;  // the first is the one that would lead

    MakingAside() {
        auto reluctant = std::make_unique<ReluctantDisplay>(std::move(run_.devices.displays[kReluctant]), run_.clock);
        display_ = reluctant.get();
        run_.devices.displays[kReluctant] = std::move(reluctant);
        const auto sources = render::PictureSources::numbered({run_.show.sources.size(), render::SolidSource{}});
        loop_.emplace(run_.site, run_.inputs, sources, sourceFolder() + "/assets", run_.devices, run_.clock);
        EXPECT_TRUE(loop_->prepare());
        EXPECT_EQ(display_->attempts, 1) << "nobody watches yet";
        loop_->makeRenderersAside();
        loop_->begin(show::ShowClock(run_.clock.now()));
    }
    void step() {
        loop_->step();
        display_->awaitOther();
    }
    void play(Time length) {
        for (const Time end = run_.clock.now() + length; run_.clock.now() < end;) step();
    }
    DeviceStatus told() const { return loop_->withFaults(run_.devices.statuses())[kReluctant]; }

    RunningShow run_;
    ReluctantDisplay* display_ = nullptr;
    std::optional<FrameLoop> loop_;
};

// Example failure: every attempt holds the render thread, so that the other output misses 15
// refreshes each time.
TEST_F(MakingAside, an_output_whose_renderer_can_never_be_made_costs_the_others_no_frame) {
    const Time begin = run_.clock.now();
    play(60s);
    EXPECT_EQ(loop_->framesLate(), 0);
    EXPECT_NEAR(static_cast<double>(loop_->framesShown(kOther)), seconds(run_.clock.now() - begin) * 30, 1.5);
    EXPECT_EQ(loop_->framesShown(kReluctant), 0);
    EXPECT_EQ(display_->attempts, 6) << "after pauses of 1, 2, 4, 8 and 16 s";
    EXPECT_FALSE(display_->wasTouched()) << "what is lent is the other thread's alone";
    EXPECT_EQ(told().state, DeviceState::Faulted);
    EXPECT_EQ(told().detail, "its picture cannot be drawn: the graphics card is too small");
    EXPECT_EQ(loop_->outputs()[kReluctant].lateFrames(), 0) << "no refresh was promised for it";
}

TEST_F(MakingAside, an_exception_in_an_attempt_is_told_as_its_reason) {
    display_->attempt = ReluctantDisplay::Attempt::Throws;
    play(10s);
    EXPECT_EQ(loop_->framesLate(), 0);
    EXPECT_EQ(told().detail, "its picture cannot be drawn: the driver is out of order");
}

// Example failure: the renderer that was made is never taken, or its first frame holds up the
// others.
TEST_F(MakingAside, an_output_whose_renderer_is_made_later_joins_the_others_without_a_late_frame) {
    play(5s);
    display_->attempt = ReluctantDisplay::Attempt::Succeeds;
    play(40s);
    EXPECT_GT(loop_->framesShown(kReluctant), 0);
    EXPECT_EQ(loop_->framesLate(), 0);
    EXPECT_FALSE(display_->wasTouched());
    EXPECT_EQ(told().state, DeviceState::Running);
    EXPECT_EQ(told().detail, "");
}

TEST_F(MakingAside, a_show_that_ends_during_an_attempt_waits_for_it_and_no_longer) {
    while (!display_->isLent()) step();
    loop_->finish(run_.clock.now());
    EXPECT_FALSE(display_->wasTouched());
    display_->patient = false;
    loop_.reset();
    EXPECT_FALSE(display_->isLent());
}

// Example failure: a driver that hangs on the other thread is told to nobody.
TEST_F(MakingAside, an_attempt_that_hangs_is_told) {
    while (!display_->isLent()) step();
    EXPECT_EQ(told().detail, "its picture cannot be drawn: the graphics card is too small");
    run_.clock.advance(FrameLoop::kHangs + 1s);
    const DeviceStatus status = told();
    EXPECT_EQ(status.state, DeviceState::Faulted);
    EXPECT_THAT(status.detail, testing::HasSubstr("does not answer while this picture is prepared"));
}

}  // namespace
}  // namespace fantascope::app
