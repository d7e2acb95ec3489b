#pragma once

#include <csignal>
#include <string>
#include <vector>

namespace fantascope::app {

// While an object lives, the signals that ask a program to end only set a flag: SIGINT (Ctrl-C),
// SIGTERM, SIGHUP (the terminal was closed), SIGQUIT, SIGPIPE (nobody reads its output). If SIGHUP
// or SIGPIPE was ignored at the start, as under nohup, it stays ignored. At most one object lives
// at a time. Thread: const methods are thread-safe.
class Interrupt {
public:
    enum class Second {
        EndsProgram,  // the second signal of a kind ends the program at once
        IsCounted  // relays may be unsafe: nothing ends it at once. SIGPWR, SIGUSR1 and SIGUSR2 ask for the end too, and what a
                   // terminal stops programs with, such as Ctrl-Z, has no effect
    };
    explicit Interrupt(Second second = Second::EndsProgram);
    ~Interrupt();  // restores the signals' previous handlers
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    bool requested() const { return count() > 0; }
    int count() const;  // of signals so far
    // The first signal's name, "SIGTERM"; "" if there was none so far.
    std::string name() const;
    // A file descriptor for poll(): readable once an end was requested.
    int file() const;

private:
    struct Replaced {
        int signal;
        struct sigaction before;
    };
    std::vector<Replaced> replaced_;
};

}  // namespace fantascope::app
