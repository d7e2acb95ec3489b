#include "drivers/display/headless.h"

#include "core/clock.h"

#include <gmock/gmock.h>

#include <thread>

namespace fantascope::drivers {
namespace {

using testing::HasSubstr;

Result<std::unique_ptr<DisplaySink>> open(const std::string& options, Clock& clock, glm::ivec2 size = {64, 36}) {
    return TRY(HeadlessDisplay::fromConfig(*ConfigNode::parse(options, "site.yaml"), {"left", size, 30})).open({clock});
}

TEST(HeadlessDisplay, refuses_an_unknown_key_and_a_picture_that_is_too_large) {
    ManualClock clock;
    EXPECT_THAT(open("driver: headless\nmonitor: HDMI-1\n", clock).error().message(),
                HasSubstr("site.yaml:2:1: monitor: unknown key"));
    EXPECT_THAT(open("driver: headless\n", clock, {1'000'000, 10}).error().message(),
                HasSubstr("site.yaml:1:1: left: 1000000 x 10 pixels"));
}

// Without a simulated site there is no plug to pull.
TEST(HeadlessDisplay, runs_without_a_simulated_site) {
    ManualClock clock;
    const auto sink = open("driver: headless\n", clock).value();
    EXPECT_EQ(sink->status().state, DeviceState::Running);
    EXPECT_TRUE(sink->present());
    EXPECT_EQ(sink->status().losses, 0);
}

// Each output's context belongs to one thread at a time.
TEST(HeadlessDisplay, serves_several_threads_with_a_display_each) {
    ManualClock clock;
    const auto mine = open("driver: headless\n", clock).value();
    ASSERT_TRUE(mine->makeCurrent());
    std::string theirError;
    bool theirsServes = false;
    std::thread([&] {
        const auto theirs = open("driver: headless\n", clock).value();
        theirsServes = theirs->makeCurrent() && theirs->presentWith(clock.now());
        if (const auto current = mine->makeCurrent(); !current) theirError = current.error().message();
    }).join();
    EXPECT_TRUE(theirsServes);
    EXPECT_THAT(theirError, HasSubstr("current on another thread"));
    EXPECT_TRUE(mine->presentWith(clock.now()));
}

}  // namespace
}  // namespace fantascope::drivers
