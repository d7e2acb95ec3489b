#include "contract/display_sink_suite.h"
#include "contract/simulated_rig.h"
#include "contract/x_server.h"

#include <gmock/gmock.h>

namespace fantascope::contract {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

// A display of the named driver as an output of a simulated site.
class DrivenDisplayRig : public SimulatedRig<DisplaySinkRig> {
public:
    explicit DrivenDisplayRig(const std::string& driver, Wrap<DisplaySink> wrap = {}) : SimulatedRig("left", std::move(wrap)) {
        options_ = ConfigNode::parse("driver: " + driver + "\n", "site.yaml").value();
        other_ = openNamed("right");
        reopen();
    }
    ManualClock& manualClock() override { return clock_; }
    DisplaySink& otherOutput() override { return *other_; }
    void letTimePass() override {
        SimulatedRig::letTimePass();
        (void)port().poll();  // a window learns of it in poll()
    }

private:
    std::unique_ptr<DisplaySink> openNamed(const std::string& name) {
        return drivers::openDisplay(options_, {name, kSize, kRefreshRate}, context_).value();
    }
    std::unique_ptr<DisplaySink> open() override { return openNamed("left"); }

    std::unique_ptr<DisplaySink> other_;
};

// A window whose program can be forced to lose it.
class WindowRig final : public DrivenDisplayRig {
public:
    explicit WindowRig(const XServer& server, Wrap<DisplaySink> wrap = {})
        : DrivenDisplayRig("glfw", std::move(wrap)), server_(server) {}
    bool loseContext() override {
        server_.killProgramOf("left");
        return true;
    }

private:
    const XServer& server_;
    const BrokenPipesIgnored ignored_;
};

template <class Broken>
std::vector<std::string> brokenBy() {
    return clausesOf(violations(displaySinkSuite(),
                                [] { return std::make_unique<DrivenDisplayRig>("headless", wrappedIn<Broken, DisplaySink>); }));
}

TEST(DisplaySinkContract, is_kept_by_the_headless_display) {
    EXPECT_THAT(violations(displaySinkSuite(), [] { return std::make_unique<DrivenDisplayRig>("headless"); }), IsEmpty());
}

TEST(DisplaySinkContract, is_kept_by_the_glfw_display) {
    const auto server = XServer::start();
    ASSERT_TRUE(server) << server.error().message();
    EXPECT_THAT(violations(displaySinkSuite(), [&] { return std::make_unique<WindowRig>(**server); }), IsEmpty());
}

class AlmostGood : public Between<DisplaySink> {
    using Between::Between;
    glm::ivec2 size() const override { return good_->size(); }
    double refreshRate() const override { return good_->refreshRate(); }
    std::int64_t nextRefresh() const override { return good_->nextRefresh(); }
    Time refreshTime(std::int64_t number) const override { return good_->refreshTime(number); }
    bool poll() override { return good_->poll(); }
    int context() const override { return good_->context(); }
    Result<void> makeCurrent() override { return good_->makeCurrent(); }
    unsigned framebuffer() const override { return good_->framebuffer(); }
    Result<void> finish() override { return good_->finish(); }
    Result<Shown> present() override { return good_->present(); }
    Result<Shown> presentWith(Time leading) override { return good_->presentWith(leading); }
};

// Otherwise its user would go on with names of another context.
class KeepsQuietAboutItsContext : public AlmostGood {
    using AlmostGood::AlmostGood;
    int context() const override { return 1; }
};
TEST(DisplaySinkContract, finds_a_lost_context_that_nobody_is_told_of) {
    const auto server = XServer::start();
    ASSERT_TRUE(server) << server.error().message();
    const auto rig = [&] { return std::make_unique<WindowRig>(**server, wrappedIn<KeepsQuietAboutItsContext, DisplaySink>); };
    EXPECT_THAT(clausesOf(violations(displaySinkSuite(), rig)),
                ElementsAre("a context that is lost is told by poll(), and another one follows"));
}

class OfAnotherSize : public AlmostGood {
    using AlmostGood::AlmostGood;
    glm::ivec2 size() const override { return {1920, 1080}; }
};
TEST(DisplaySinkContract, finds_a_display_of_another_size) {
    EXPECT_THAT(brokenBy<OfAnotherSize>(), ElementsAre("it has the size and the refresh rate that it was asked for"));
}

// Without a window system there is no framebuffer 0.
class LendsNoFramebuffer : public AlmostGood {
    using AlmostGood::AlmostGood;
    unsigned framebuffer() const override { return 0; }
};
TEST(DisplaySinkContract, finds_a_framebuffer_that_cannot_be_drawn_into) {
    EXPECT_THAT(brokenBy<LendsNoFramebuffer>(), Contains("its framebuffer is of its size and holds stored sRGB values"));
}

class NeverWaits : public AlmostGood {
    using AlmostGood::AlmostGood;
    Result<Shown> present() override { return good_->presentWith(Time{}); }
};
TEST(DisplaySinkContract, finds_a_display_that_does_not_pace) {
    EXPECT_THAT(
        brokenBy<NeverWaits>(),
        Contains("leading frames are shown at one refresh after the other, and the display waits for it or for the one before"));
}

// An endless queue: no frame is ever late, and a button's effect comes later and later.
class QueuesEverything : public AlmostGood {
    using AlmostGood::AlmostGood;
    std::int64_t nextRefresh() const override { return std::max(good_->nextRefresh(), shown_ + 1); }
    Result<Shown> present() override {
        shown_ = nextRefresh();
        return Shown{shown_, good_->refreshTime(shown_)};
    }
    std::int64_t shown_ = 0;
};
TEST(DisplaySinkContract, finds_a_display_that_holds_more_than_one_frame) {
    EXPECT_THAT(
        brokenBy<QueuesEverything>(),
        Contains("leading frames are shown at one refresh after the other, and the display waits for it or for the one before"));
}

class AlwaysWaits : public AlmostGood {
    using AlmostGood::AlmostGood;
    Result<Shown> presentWith(Time) override {
        const Shown shown = TRY(good_->present());
        context_.clock.sleepUntil(shown.at);
        return shown;
    }
};
TEST(DisplaySinkContract, finds_a_follower_that_waits_for_a_refresh_of_its_own) {
    EXPECT_THAT(brokenBy<AlwaysWaits>(), Contains("a following frame is shown within the refresh that is running, without "
                                                  "waiting, where the leading one is shown already"));
}

class RunsAhead : public AlmostGood {
    using AlmostGood::AlmostGood;
    Result<Shown> presentWith(Time) override { return good_->presentWith(context_.clock.now()); }
};
TEST(DisplaySinkContract, finds_a_follower_that_does_not_wait_for_the_leader) {
    EXPECT_THAT(brokenBy<RunsAhead>(),
                ElementsAre("a following frame is shown with the leading one, and its display does not wait longer than that"));
}

// With this no frame would ever be late.
class NumbersItsFrames : public AlmostGood {
    using AlmostGood::AlmostGood;
    Result<Shown> present() override {
        Shown shown = TRY(good_->present());
        shown.refresh = ++frames_;
        shown.at = good_->refreshTime(frames_);
        return shown;
    }
    std::int64_t frames_ = 0;
};
TEST(DisplaySinkContract, finds_a_display_that_counts_its_frames_and_not_its_refreshes) {
    EXPECT_THAT(brokenBy<NumbersItsFrames>(), Contains("a slow frame misses refreshes"));
}

class SaysItsRefreshesAreUneven : public AlmostGood {
    using AlmostGood::AlmostGood;
    Time refreshTime(std::int64_t number) const override { return good_->refreshTime(number) + Time(number % 2 * 1'000'000); }
};
TEST(DisplaySinkContract, finds_uneven_refreshes) {
    EXPECT_THAT(brokenBy<SaysItsRefreshesAreUneven>(), Contains("refreshes are even and counted, shown or not"));
}

// Presents whatever context happens to be current.
class TakesAnyContext : public AlmostGood {
    using AlmostGood::AlmostGood;
    Result<Shown> presentWith(Time) override {
        if (!running()) return Error("left is lost");
        return Shown{good_->nextRefresh() - 1, good_->refreshTime(good_->nextRefresh() - 1)};
    }
};
TEST(DisplaySinkContract, finds_a_present_that_leaves_another_context_current) {
    EXPECT_THAT(brokenBy<TakesAnyContext>(), Contains("finish() and present() make their own context current"));
}

class DeniesItsLoss : public AlmostGood {
    using AlmostGood::AlmostGood;
    bool poll() override { return true; }
};
TEST(DisplaySinkContract, finds_a_lost_display_that_claims_to_be_there) {
    EXPECT_THAT(brokenBy<DeniesItsLoss>(), Contains("a lost display shows nothing, says so and names itself, at once"));
}

// Nothing can be prepared before people watch.
class HasNoContextWhileAway : public AlmostGood {
    using AlmostGood::AlmostGood;
    Result<void> makeCurrent() override {
        if (!running()) return Error("left is gone");
        return good_->makeCurrent();
    }
};
TEST(DisplaySinkContract, finds_a_context_that_is_away_with_its_display) {
    EXPECT_THAT(brokenBy<HasNoContextWhileAway>(),
                UnorderedElementsAre("a display that is missing at the start has its context all the same",
                                     "what is in its context outlives a loss"));
}

// The next drawing goes to another display's context.
class FinishesWhateverIsCurrent : public AlmostGood {
    using AlmostGood::AlmostGood;
    Result<void> finish() override {
        glFinish();
        return {};
    }
};
TEST(DisplaySinkContract, finds_a_finish_that_leaves_another_context_current) {
    EXPECT_THAT(brokenBy<FinishesWhateverIsCurrent>(), ElementsAre("finish() and present() make their own context current"));
}

class StaysAway : public AlmostGood {
    using AlmostGood::AlmostGood;
    bool poll() override { return good_->poll() && good_->status().losses == 0; }
};
TEST(DisplaySinkContract, finds_a_display_that_does_not_come_back) {
    EXPECT_THAT(brokenBy<StaysAway>(), Contains("a lost device comes back by itself and the same object serves"));
}

// A loss discards everything, and the return starts anew.
class LosesItsContext : public AlmostGood {
public:
    using AlmostGood::AlmostGood;

private:
    Result<void> makeCurrent() override {
        if (const int losses = good_->status().losses; losses > lossesSeen_ && running()) {
            lossesSeen_ = losses;
            fresh_ = openAnother();
        }
        TRY(good_->makeCurrent());
        return fresh_ ? fresh_->makeCurrent() : Result<void>();
    }
    unsigned framebuffer() const override { return fresh_ ? fresh_->framebuffer() : good_->framebuffer(); }
    std::unique_ptr<DisplaySink> openAnother() const {
        const ConfigNode options = ConfigNode::parse("driver: headless\n", "site.yaml").value();
        return drivers::openDisplay(options, {"left", DisplaySinkRig::kSize, DisplaySinkRig::kRefreshRate}, context_).value();
    }
    int lossesSeen_ = 0;
    std::unique_ptr<DisplaySink> fresh_;
};
TEST(DisplaySinkContract, finds_a_display_whose_context_dies_with_it) {
    EXPECT_THAT(brokenBy<LosesItsContext>(), Contains("what is in its context outlives a loss"));
}

}  // namespace
}  // namespace fantascope::contract
