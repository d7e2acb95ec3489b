#include "core/log.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <future>
#include <sstream>
#include <string>
#include <vector>

namespace fantascope {
namespace {

// Two ends: what is written to the second is read from the first.
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
        ::fcntl(ends_[0], F_SETFL, ::fcntl(ends_[0], F_GETFL) | O_NONBLOCK);
        ::dup2(ends_[1], STDERR_FILENO);
    }
    ~Unread() override {
        ::dup2(before_, STDERR_FILENO);
        for (const int file : {before_, ends_[0], ends_[1]}) ::close(file);
    }
    // Reads what is available; a terminal delivers it when the kernel is ready.
    std::string read() {
        pollfd written{ends_[0], POLLIN, 0};
        EXPECT_EQ(::poll(&written, 1, 30000), 1);
        std::string all;
        char bytes[4096];
        for (ssize_t count; (count = ::read(ends_[0], bytes, sizeof bytes)) > 0;)
            all.append(bytes, static_cast<std::size_t>(count));
        std::erase(all, '\r');
        return all;
    }

    const int before_ = ::dup(STDERR_FILENO);
    const Ends ends_ = GetParam()();
};

struct Told {
    int whole = 0;
    int lost = 0;
};

// Parses a log whose messages end in a full stop. After a line that was cut short, the count of
// lost lines is on the next line; after a complete one there is an empty line between. A count
// before a line that was cut short is reported again.
Told toldBy(const std::string& log) {
    Told told;
    int lost = 0;
    std::vector<std::string> lines;
    std::istringstream stream(log);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    lines.emplace_back();
    for (std::size_t line = 0; line + 1 < lines.size(); ++line) {
        if (lines[line].starts_with('('))
            lost = std::stoi(lines[line].substr(1));
        else if (lines[line + 1].starts_with('('))
            lost = 0;
        else if (!lines[line].empty()) {
            told.whole += 1;
            told.lost += lost;
            lost = 0;
        }
    }
    return told;
}

// Example failure: somebody presses Ctrl-S, or does not scroll `run 2>&1 | less`, and the thread
// that sends the lamps blocks.
TEST_P(Unread, holds_up_nobody_who_logs_and_is_told_what_it_lost) {
    int logged = 10000;
    auto logging = std::async(std::launch::async, [logged] {
        for (int line = 0; line < logged; ++line) log::info("dmx", "universe 1 goes out 30.0 times a second.");
    });
    const bool waits = logging.wait_for(std::chrono::seconds(30)) != std::future_status::ready;
    EXPECT_FALSE(waits);
    std::string all;
    while (logging.wait_for(std::chrono::seconds(0)) != std::future_status::ready) all += read();
    if (waits) return;
    for (std::string last; last.empty() || all.find(last + '\n') == std::string::npos;) {
        last = "somebody reads again, line " + std::to_string(++logged) + '.';
        log::info("dmx", last);
        all += read();
    }
    const Told told = toldBy(all);
    EXPECT_GT(told.lost, 0);
    EXPECT_EQ(told.whole + told.lost, logged) << all;
}

INSTANTIATE_TEST_SUITE_P(By, Unread, testing::Values(&aPipe, &aSocket, &aTerminal));

// Ctrl-S stops a terminal that still has room.
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
