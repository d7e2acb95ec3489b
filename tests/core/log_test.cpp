#include "core/log.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <future>
#include <string>

namespace fantascope {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Two ends: what is written to the second one is read from the first.
using Ends = std::array<int, 2>;

Ends aPipe() {
    Ends ends;
    EXPECT_EQ(::pipe(ends.data()), 0);
    return ends;
}
Ends aSocket() {
    Ends ends;
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    return ends;
}
Ends aTerminal() {
    const int far = ::posix_openpt(O_RDWR | O_NOCTTY);
    EXPECT_EQ(::grantpt(far), 0);
    EXPECT_EQ(::unlockpt(far), 0);
    return {far, ::open(::ptsname(far), O_RDWR | O_NOCTTY)};
}

class Unread : public testing::TestWithParam<Ends (*)()> {
protected:
    Unread() {
        const int flags = ::fcntl(ends_[1], F_GETFL);
        ::fcntl(ends_[1], F_SETFL, flags | O_NONBLOCK);
        const std::string dots(64, '.');
        while (::write(ends_[1], dots.data(), dots.size()) > 0) continue;
        while (::write(ends_[1], dots.data(), 1) > 0) continue;
        ::fcntl(ends_[1], F_SETFL, flags);
        ::fcntl(ends_[0], F_SETFL, ::fcntl(ends_[0], F_GETFL) | O_NONBLOCK);
        ::dup2(ends_[1], STDERR_FILENO);
    }
    ~Unread() override {
        ::dup2(before_, STDERR_FILENO);
        for (const int file : {before_, ends_[0], ends_[1]}) ::close(file);
    }
    std::string read() {
        std::string all;
        char bytes[4096];
        for (ssize_t count; (count = ::read(ends_[0], bytes, sizeof bytes)) > 0;)
            all.append(bytes, static_cast<std::size_t>(count));
        return all;
    }

    const int before_ = ::dup(STDERR_FILENO);
    const Ends ends_ = GetParam()();
};

// Example failure: somebody presses Ctrl-S, or `run 2>&1 | less` is not scrolled, and the thread that sends the lamps stands still.
TEST_P(Unread, holds_up_nobody_who_logs_and_is_told_what_it_lost) {
    auto logging = std::async(std::launch::async, [] {
        for (int line = 0; line < 3; ++line) log::info("dmx", "universe 1 goes out 30.0 times a second");
    });
    const bool waits = logging.wait_for(std::chrono::seconds(30)) != std::future_status::ready;
    EXPECT_FALSE(waits);
    read();
    logging.get();
    if (waits) return;
    log::info("dmx", "somebody reads again");
    EXPECT_THAT(read(), AllOf(HasSubstr("(3 lines of the log were lost: nobody read them)"), HasSubstr("somebody reads again")));
    log::info("dmx", "and goes on");
    EXPECT_THAT(read(), AllOf(testing::Not(HasSubstr("lost")), HasSubstr("and goes on")));
}

INSTANTIATE_TEST_SUITE_P(By, Unread, testing::Values(&aPipe, &aSocket, &aTerminal));

// Ctrl-S stops a terminal that has room.
TEST(Log, a_terminal_that_is_stopped_holds_up_nobody) {
    const Ends ends = aTerminal();
    ASSERT_EQ(::tcflow(ends[1], TCOOFF), 0);
    const int before = ::dup(STDERR_FILENO);
    ::dup2(ends[1], STDERR_FILENO);
    auto logging = std::async(std::launch::async, [] { log::info("dmx", "nobody sees this"); });
    EXPECT_EQ(logging.wait_for(std::chrono::seconds(30)), std::future_status::ready);
    ::tcflow(ends[1], TCOON);
    logging.get();
    ::dup2(before, STDERR_FILENO);
    for (const int file : {before, ends[0], ends[1]}) ::close(file);
}

}  // namespace
}  // namespace fantascope
