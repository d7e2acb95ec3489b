#include "app/interrupt.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace fantascope::app
