#include "contract/display_sink_contract.h"

#include "drivers/display/glfw.h"
#include "drivers/display/headless.h"
#include "drivers/site/world.h"

#include "contract/x_server.h"
#include "core/check.h"

#include <gmock/gmock.h>

#include <utility>

namespace fantascope::contract {
namespace {

using testing::Contains;
using testing::IsEmpty;

struct Surrounding {
    ManualClock clock;
    site::World world{clock};
};

using Open = Result<std::unique_ptr<DisplaySink>> (*)(const ConfigNode&, const drivers::DisplayRequest&,
                                                      const drivers::Surroundings&);

// Two displays of one driver in a simulated site.
std::unique_ptr<DisplaySinkRig> makeRig(Open open, const std::string& options) {
    const auto around = std::make_shared<Surrounding>();
    auto rig = std::make_unique<DisplaySinkRig>();
    rig->name = "left";
    rig->size = {64, 36};
    rig->clock = std::shared_ptr<ManualClock>(around, &around->clock);
    rig->surroundings = around;
    const auto opened = [&](const std::string& name) {
        auto sink = open(*ConfigNode::parse(options, "site.yaml"), {name, rig->size, 30}, {around->clock, &around->world});
        FANTASCOPE_CHECK(sink.has_value(), sink.error().message());
        return std::move(sink).value();
    };
    rig->sink = opened("left");
    rig->neighbour = opened("right");
    rig->unplug = [around] { around->world.setPlugged("left", false); };
    rig->plugIn = [around] { around->world.setPlugged("left", true); };
    return rig;
}

std::unique_ptr<DisplaySinkRig> headlessRig() { return makeRig(drivers::HeadlessDisplay::open, "driver: headless\n"); }

TEST(DisplaySinkContract, headless_display_keeps_it) { EXPECT_THAT(violations(displaySinkContract(), headlessRig), IsEmpty()); }

TEST(DisplaySinkContract, glfw_display_keeps_it) {
    const auto server = XServer::start();
    ASSERT_TRUE(server) << server.error().message();
    const auto rig = [] { return makeRig(drivers::GlfwDisplay::open, "driver: glfw\n"); };
    EXPECT_THAT(violations(displaySinkContract(), rig), IsEmpty());
}

// A good display with the promises of a bad one; each of the following breaks one promise, and the suite must say which.
class Broken : public DisplaySink {
public:
    explicit Broken(DisplaySinkRig& rig) : rig_(rig), good_(std::move(rig.sink)) {}
    DeviceStatus status() const override { return good_->status(); }
    glm::ivec2 size() const override { return good_->size(); }
    double refreshRate() const override { return good_->refreshRate(); }
    std::int64_t nextRefresh() const override { return good_->nextRefresh(); }
    Time refreshTime(std::int64_t number) const override { return good_->refreshTime(number); }
    Result<void> makeCurrent() override { return good_->makeCurrent(); }
    unsigned framebuffer() const override { return good_->framebuffer(); }
    Result<Shown> present(bool paced) override { return good_->present(paced); }

protected:
    DisplaySinkRig& rig_;
    std::unique_ptr<DisplaySink> good_;
};

// The clauses that headless displays behind a Bad one violate.
template <class Bad>
std::vector<std::string> brokenBy() {
    return clausesOf(violations(displaySinkContract(), [] {
        auto rig = headlessRig();
        rig->sink = std::make_unique<Bad>(*rig);
        return rig;
    }));
}

struct OfAnotherSize : Broken {
    using Broken::Broken;
    glm::ivec2 size() const override { return {640, 480}; }
};
TEST(DisplaySinkContract, another_size_is_found_out) {
    EXPECT_THAT(brokenBy<OfAnotherSize>(), Contains("runs from the start as it was asked to"));
}

struct LinearFramebuffer : Broken {
    using Broken::Broken;
    unsigned framebuffer() const override { return 0; }  // where there is no window system there is none
};
TEST(DisplaySinkContract, a_framebuffer_that_cannot_be_drawn_into_is_found_out) {
    EXPECT_THAT(brokenBy<LinearFramebuffer>(), Contains("its framebuffer holds stored sRGB values"));
}

struct Impatient : Broken {
    using Broken::Broken;
    Result<Shown> present(bool) override { return Broken::present(false); }
};
TEST(DisplaySinkContract, a_paced_frame_that_does_not_wait_is_found_out) {
    EXPECT_THAT(brokenBy<Impatient>(), Contains("a paced frame waits for the next refresh"));
}

struct AlwaysWaiting : Broken {
    using Broken::Broken;
    Result<Shown> present(bool) override { return Broken::present(true); }
};
TEST(DisplaySinkContract, a_follower_that_waits_is_found_out) {
    EXPECT_THAT(brokenBy<AlwaysWaiting>(), Contains("an unpaced frame does not wait"));
}

// Numbers its own frames instead of the display's refreshes: nothing is ever late.
struct CountingFrames : Broken {
    using Broken::Broken;
    Result<Shown> present(bool paced) override {
        Shown shown = TRY(Broken::present(paced));
        shown.refresh = ++frames_;
        return shown;
    }
    std::int64_t frames_ = 0;
};
TEST(DisplaySinkContract, counting_frames_for_refreshes_is_found_out) {
    EXPECT_THAT(brokenBy<CountingFrames>(), Contains("a slow frame misses refreshes"));
}

struct UnevenRefreshes : Broken {
    using Broken::Broken;
    Time refreshTime(std::int64_t number) const override { return Broken::refreshTime(number) + Time(number % 2 * 1'000'000); }
};
TEST(DisplaySinkContract, uneven_refreshes_are_found_out) {
    EXPECT_THAT(brokenBy<UnevenRefreshes>(), Contains("refreshes are even and counted"));
}

struct LeavingContextAway : Broken {
    using Broken::Broken;
    Result<Shown> present(bool paced) override {
        const Shown shown = TRY(Broken::present(paced));
        TRY(rig_.neighbour->makeCurrent());
        return shown;
    }
};
TEST(DisplaySinkContract, a_context_left_elsewhere_is_found_out) {
    EXPECT_THAT(brokenBy<LeavingContextAway>(), Contains("present() takes its own context"));
}

struct DrawingIntoNeighbour : Broken {
    using Broken::Broken;
    Result<void> makeCurrent() override { return rig_.neighbour->makeCurrent(); }
};
TEST(DisplaySinkContract, a_picture_shared_with_the_neighbour_is_found_out) {
    EXPECT_THAT(brokenBy<DrawingIntoNeighbour>(), Contains("leaves its neighbour alone"));
}

struct DenyingLoss : Broken {
    using Broken::Broken;
    Result<void> makeCurrent() override {
        if (auto current = Broken::makeCurrent(); current || status().losses == 0) return current;
        return {};
    }
};
TEST(DisplaySinkContract, a_loss_that_is_no_error_is_found_out) {
    EXPECT_THAT(brokenBy<DenyingLoss>(), Contains("a loss is an error, noticed, counted and not waited for"));
}

// The first loss is for good.
struct NeverBack : Broken {
    using Broken::Broken;
    Result<void> makeCurrent() override {
        if (status().losses > 0) return Error("left is gone");
        return Broken::makeCurrent();
    }
};
TEST(DisplaySinkContract, a_display_that_stays_away_is_found_out) {
    EXPECT_THAT(brokenBy<NeverBack>(), Contains("comes back with its context"));
}

}  // namespace
}  // namespace fantascope::contract
