#include "app/base/interrupt.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace fantascope::app {
namespace {

TEST(Interrupt, the_first_signal_raises_a_flag_and_a_new_one_starts_lowered) {
    for (const int signal : {SIGINT, SIGTERM}) {
        const Interrupt interrupt;
        EXPECT_FALSE(interrupt.requested());
        std::raise(signal);
        EXPECT_TRUE(interrupt.requested());
    }
}

// Example failure: a solver that hangs could be ended by kill -9 alone.
TEST(InterruptDeathTest, the_second_ctrl_c_ends_the_program) {
    const auto pressTwice = [] {
        const Interrupt interrupt;
        std::raise(SIGINT);
        std::raise(SIGINT);
    };
    EXPECT_EXIT(pressTwice(), testing::KilledBySignal(SIGINT), "");
}

// Example failure: a terminal that is closed, or Ctrl-\\, ends a show that has switched the street
// lamps off.
TEST(Interrupt, counts_every_signal_that_asks_a_show_to_end) {
    std::signal(SIGHUP, SIG_DFL);  // ignored where the tests run under nohup
    int sent = 0;
    const Interrupt interrupt(Interrupt::Second::IsCounted);
    for (const int signal : {SIGHUP, SIGINT, SIGTERM, SIGQUIT, SIGUSR1, SIGUSR2, SIGPWR, SIGINT}) {
        std::raise(signal);
        EXPECT_EQ(interrupt.count(), ++sent);
    }
    EXPECT_EQ(interrupt.name(), "SIGHUP");
}

// Example failure: a module that hangs up ends the night, an X server that ends ends `devices
// --watch`.
TEST(Interrupt, a_write_of_its_own_to_somebody_who_is_gone_asks_for_nothing) {
    for (const auto second : {Interrupt::Second::IsCounted, Interrupt::Second::EndsProgram}) {
        int ends[2];
        ASSERT_EQ(pipe(ends), 0);
        close(ends[0]);
        const Interrupt interrupt(second);
        for (int i = 0; i < 2; ++i) EXPECT_EQ(write(ends[1], "x", 1), -1);
        EXPECT_FALSE(interrupt.requested());
        const pid_t other = fork();
        if (other == 0) _exit(kill(getppid(), SIGPIPE));
        waitpid(other, nullptr, 0);
        EXPECT_TRUE(interrupt.requested()) << "somebody else's is meant";
        close(ends[1]);
    }
}

// Example failure: `fantascope pose ... | head -1` loses the best poses so far.
TEST(InterruptDeathTest, what_is_printed_for_nobody_asks_for_the_end) {
    const auto printForNobody = [] {
        int ends[2];
        if (pipe(ends) != 0) _exit(1);
        dup2(ends[1], STDOUT_FILENO);
        close(ends[0]);
        const Interrupt interrupt;
        for (int i = 0; i < 2; ++i)
            if (write(STDOUT_FILENO, "x", 1) != -1) _exit(2);
        _exit(interrupt.name() == "SIGPIPE" ? 0 : 3);
    };
    EXPECT_EXIT(printForNobody(), testing::ExitedWithCode(0), "");
}

TEST(Interrupt, a_closed_terminal_asks_for_nothing_under_nohup) {
    const auto before = std::signal(SIGHUP, SIG_IGN);
    {
        const Interrupt interrupt(Interrupt::Second::IsCounted);
        std::raise(SIGHUP);
        EXPECT_FALSE(interrupt.requested());
    }
    std::signal(SIGHUP, before);
}

}  // namespace
}  // namespace fantascope::app
