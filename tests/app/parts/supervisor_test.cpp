#include "app/parts/supervisor.h"

#include "core/clock.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <functional>
#include <new>
#include <utility>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;

void say(const char* what) { std::fputs(what, stderr); }

// What a run hands over; it says what it is told to do.
Supervisor::Run speaking() {
    return {[] { say("end;"); },
            [] { say("hurry;"); },
            [] { return true; },
            [] { say("close;"); },
            [](const std::string& why) { say(why.c_str()); },
            {}};
}

class SupervisorDeathTest : public testing::Test {
protected:
    void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

// Example failure: a graphics card that hangs keeps the program until somebody kills it, and the
// street stays dark.
TEST_F(SupervisorDeathTest, a_step_that_hangs_is_not_waited_for_and_the_lights_come_first) {
    const auto hang = [] {
        const Interrupt interrupt(Interrupt::Second::IsCounted);
        Supervisor supervisor(interrupt, nullptr);
        supervisor.attend(speaking());
        supervisor.step("showing the pictures", 20ms);
        std::raise(SIGTERM);
        for (;;) pause();
    };
    EXPECT_EXIT(hang(), testing::ExitedWithCode(1), "^end;hurry;close;it hung while showing the pictures");
}

TEST_F(SupervisorDeathTest, who_presses_ctrl_c_again_waits_for_the_lights_alone) {
    const auto impatient = [] {
        const Interrupt interrupt(Interrupt::Second::IsCounted);
        Supervisor supervisor(interrupt, nullptr);
        supervisor.attend(speaking());
        supervisor.step("finishing the recording", 1h);
        SteadyClock clock;
        for (;; clock.sleepUntil(clock.now() + 100ms)) std::raise(SIGINT);
    };
    EXPECT_EXIT(impatient(), testing::ExitedWithCode(1),
                "^end;hurry;close;it was interrupted again while finishing the recording");
}

// Example failure: with an X server that hangs the program waits for ever and says nothing.
TEST_F(SupervisorDeathTest, a_set_up_that_takes_long_is_told_before_anybody_asks_for_the_end) {
    const auto wait = [] {
        int said[2];
        if (pipe(said) != 0) _exit(2);
        const int terminal = dup(STDERR_FILENO);
        dup2(said[1], STDERR_FILENO);
        const Interrupt interrupt(Interrupt::Second::IsCounted);
        Supervisor supervisor(interrupt, nullptr);
        supervisor.step("opening the devices", 20ms);
        char line[256];
        const ssize_t length = read(said[0], line, sizeof line);
        _exit(length > 0 && write(terminal, line, static_cast<std::size_t>(length)) == length ? 0 : 1);
    };
    EXPECT_EXIT(wait(), testing::ExitedWithCode(0), "still opening the devices; lamps and relays wait for that. Ctrl-C ends");
}

// A run that is over has nothing left to close.
TEST_F(SupervisorDeathTest, a_step_after_the_lights_are_closed_may_hang_too) {
    const auto hang = [] {
        const Interrupt interrupt(Interrupt::Second::IsCounted);
        Supervisor supervisor(interrupt, nullptr);
        supervisor.attend(speaking());
        supervisor.release();
        supervisor.step("closing the devices", 20ms);
        supervisor.requestEnd();
        for (;;) pause();
    };
    EXPECT_EXIT(hang(), testing::ExitedWithCode(1),
                "^.fantascope: error: the show was to end, but it hung while closing the devices");
}

// A run that is told of its end by `end`, and whose next step hangs.
[[noreturn]] void hangAfter(std::function<void()> end, Time patience) {
    const Interrupt interrupt(Interrupt::Second::IsCounted);
    Supervisor supervisor(interrupt, nullptr);
    Supervisor::Run run = speaking();
    run.end = std::move(end);
    supervisor.attend(std::move(run));
    supervisor.step("showing the pictures", patience);
    supervisor.requestEnd();
    for (;;) pause();
}

// Example failures: the program is ended and the lamps stay as they are; the relays are never told
// of the end.
TEST_F(SupervisorDeathTest, an_end_that_fails_is_tried_again_and_the_failure_is_told_once) {
    const auto failThrice = [calls = 0]() mutable {
        if (++calls < 4) throw std::bad_alloc();
        say("end;");
    };
    EXPECT_EXIT(hangAfter(failThrice, 1s), testing::ExitedWithCode(1),
                "^.fantascope: error: the supervisor failed: std::bad_alloc.end;hurry;close;it hung while showing the pictures");
}

// Example failure: the end that fails every time hides that a step hangs.
TEST_F(SupervisorDeathTest, an_end_that_always_fails_keeps_nobody_from_leaving) {
    const auto fail = [] { throw std::bad_alloc(); };
    EXPECT_EXIT(hangAfter(fail, 100ms), testing::ExitedWithCode(1), "hurry;close;it hung while showing the pictures");
}

TEST(Supervisor, waits_for_what_is_in_time) {
    const Interrupt interrupt(Interrupt::Second::IsCounted);
    int ends = 0;
    {
        Supervisor supervisor(interrupt, nullptr);
        EXPECT_FALSE(supervisor.ending());
        std::raise(SIGTERM);
        EXPECT_TRUE(supervisor.ending()) << "before anybody looks";
        supervisor.attend(
            {[&] { ++ends; }, [] { FAIL(); }, [] { return true; }, [] { FAIL(); }, [](const std::string&) { FAIL(); }, {}});
        for (int step = 0; step < 10; ++step) supervisor.step("some step");
    }
    EXPECT_LE(ends, 1);
}

// Example failure: on a busy machine the frames that are not written yet at the end are lost, and
// the report with them.
TEST(Supervisor, waits_for_a_step_that_gets_on) {
    const Interrupt interrupt(Interrupt::Second::IsCounted);
    Supervisor supervisor(interrupt, nullptr);
    supervisor.attend({[] {}, [] { FAIL(); }, [] { return true; }, [] { FAIL(); }, [](const std::string&) { FAIL(); }, {}});
    supervisor.requestEnd();
    supervisor.step("recording", 2s);
    SteadyClock clock;
    for (const Time end = clock.now() + 3s; clock.now() < end; clock.sleepUntil(clock.now() + 10ms)) supervisor.advance();
    supervisor.step("done");
}

}  // namespace
}  // namespace fantascope::app
