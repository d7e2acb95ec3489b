#pragma once

#include <csignal>
#include <string>
#include <vector>

namespace fantascope::app {

// While one lives, the signals that ask a program to end only raise a flag: SIGINT (Ctrl-C),
// SIGTERM, SIGHUP (the terminal was closed), SIGQUIT, SIGPIPE (nobody reads what it prints). SIGHUP
// and SIGPIPE have no effect where they had none at the start, as under nohup. At most one lives at
// a time. Thread: const methods are thread-safe.
class Interrupt {
public:
    enum class Second {
        EndsProgram,  // the second signal of a kind ends the program at once
        IsCounted  // relays may be unsafe: nothing ends it at once. SIGPWR, SIGUSR1 and SIGUSR2 ask for the end too, and what a
                   // terminal stops programs with, such as Ctrl-Z, has no effect
    };
    explicit Interrupt(Second second = Second::EndsProgram);
    ~Interrupt();  // the signals do again what they did before
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    bool requested() const { return count() > 0; }
    int count() const;  // of signals so far
    // The first signal's name: "SIGTERM"; "" while there was none.
    std::string name() const;
    // Can be read once an end was requested: for poll().
    int file() const;

private:
    struct Replaced {
        int signal;
        struct sigaction before;
    };
    std::vector<Replaced> replaced_;
};

}  // namespace fantascope::app
