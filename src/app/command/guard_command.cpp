#include "app/command/commands.h"
#include "app/site/relay_guard.h"
#include "drivers/registry.h"

#include "show/patch.h"
#include "show/site/site.h"

#include "core/clock.h"
#include "core/file.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <thread>
#include <vector>

namespace fantascope::app {
namespace {

constexpr Time kAgain = std::chrono::milliseconds(10);

struct Options {
    std::filesystem::path site, text;
    std::string bank;
};

// Only SIGKILL ends it from outside.
void ignoreSignals() {
    for (int signal = 1; signal < NSIG; ++signal)
        if (signal != SIGSEGV && signal != SIGBUS && signal != SIGFPE && signal != SIGILL && signal != SIGABRT &&
            signal != SIGCHLD)
            ::signal(signal, SIG_IGN);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
}

// Waits for the run's end. Returns whether the run said that all is safe.
bool runSaidSafe() {
    std::string said;
    char bytes[64];
    for (;;) {
        const ssize_t count = read(STDIN_FILENO, bytes, sizeof bytes);
        if (count == 0 || (count < 0 && errno != EINTR)) return said == kAllIsSafe;
        if (count > 0) said.append(bytes, static_cast<std::size_t>(count));
    }
}

void say(const std::string& sentence) { std::fputs(("fantascope: " + sentence + "\n").c_str(), stderr); }

// Writes the safe states until the bank has confirmed them. Error: it has not by `latest`; says
// why.
Result<void> makeSafe(RelayBank& bank, const std::vector<bool>& safe, Clock& clock, Time latest) {
    for (;;) {
        auto written = bank.write(safe);
        if (written || clock.now() >= latest) return written;
        clock.sleepUntil(clock.now() + kAgain);
    }
}

Result<void> guard(const Options& options) {
    ignoreSignals();
    const show::Site site = TRY(show::parseSite(TRY(readFile(options.text)), options.site));
    if (runSaidSafe()) return {};
    SteadyClock clock;
    const Time latest = clock.now() + RelayGuard::kPatience;
    struct Bank {
        std::string name;
        std::vector<bool> safe;
        Result<std::unique_ptr<RelayBank>> device;
        Result<void> made;
    };
    std::vector<Bank> banks;
    for (std::size_t number = 0; number < site.relayBanks.size(); ++number) {
        const auto& [name, device] = site.relayBanks[number];
        if (!options.bank.empty() && name != options.bank) continue;
        auto safe = show::safeCoils(site, number);
        auto opened = drivers::openRelayBank(device.options, name, safe, {clock});
        banks.push_back({name, std::move(safe), std::move(opened), {}});
    }
    {
        std::vector<std::jthread> threads;  // a dead bank delays no other
        for (Bank& bank : banks)
            threads.emplace_back(
                [&] { bank.made = bank.device ? makeSafe(**bank.device, bank.safe, clock, latest) : bank.device.error(); });
    }
    bool all = true;
    for (const Bank& bank : banks) {
        if (bank.made) continue;
        all = false;
        say(fmt::format(
            "RELAYS MAY BE UNSAFE: '{}' has not confirmed its safe states within {:g} s: {}. Switch them at the module",
            bank.name, seconds(RelayGuard::kPatience), bank.made.error().message()));
    }
    if (!all) return Error("the run has ended, and not all of its relays are safe");
    say("the run has ended without a word; its guard has made its relays safe");
    return {};
}

void declare(Command& command, Options& options) {
    command.add("site", options.site, "the site file").required();
    command.add("text", options.text, "a file with what stood in it when the run began").required();
    command.add("--bank", options.bank, "of its relay banks this one alone");
    command.hidden();
}

}  // namespace

void addGuardCommand(Program& program) {
    addCommand<Options>(program, kGuardCommand, "Makes a site's relays safe when a run ends without a word", declare, guard);
}

}  // namespace fantascope::app
