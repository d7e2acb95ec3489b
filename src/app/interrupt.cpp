#include "app/interrupt.h"

#include <signal.h>

#include <atomic>

namespace fantascope::app {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM};
std::atomic<bool> raised = false;  // lock-free, so a signal handler may write it

void handle(void (*handler)(int), int flags) {
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_flags = flags;
    for (const int signal : kSignals) ::sigaction(signal, &action, nullptr);
}

}  // namespace

Interrupt::Interrupt() {
    raised = false;
    // Reset on the first: the second of its kind meets the system's default, which ends the program.
    handle([](int) { raised = true; }, SA_RESTART | static_cast<int>(SA_RESETHAND));
}

Interrupt::~Interrupt() { handle(SIG_DFL, 0); }

bool Interrupt::requested() const { return raised; }

}  // namespace fantascope::app
