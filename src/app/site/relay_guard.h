#pragma once

#include "drivers/common/file_handle.h"

#include "show/site/site.h"

#include "core/clock.h"
#include "core/result.h"

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fantascope::app {

// The subcommand that a RelayGuard starts. It is not for people, so the help does not list it.
constexpr const char* kGuardCommand = "guard-relays";
// A run that ends in order writes this into the guard's pipe.
constexpr std::string_view kAllIsSafe = "safe\n";

// A small process of this program that outlives a run
// (docs/decisions/0030-a-guard-outlives-the-run.md). If the run ends without that word, for any
// reason, the guard writes the safe states of the site's relays until every bank has confirmed
// them, for at most kPatience. Thread: thread-safe.
class RelayGuard {
public:
    static constexpr Time kPatience = std::chrono::seconds(30);

    // Starts it. The guard reads the site as the run has read it, even if the file has changed
    // since. It keeps `held` (files of claims) open until it ends. A `bank` limits it to that bank.
    // Error: no process can be started.
    static Result<std::unique_ptr<RelayGuard>> start(const show::Site& site, std::vector<int> held, std::string bank = {});
    // Dismisses a guard that was never armed: nothing was switched. An armed one starts to work.
    ~RelayGuard();
    RelayGuard(const RelayGuard&) = delete;
    RelayGuard& operator=(const RelayGuard&) = delete;

    // Call it before the first relay is switched: from now on relays may be unsafe.
    void arm();
    bool hasDied() const;
    // Starts another one in its place. Error: as start().
    Result<void> restart();
    // The relays are safe: the guard ends and gives its claims up. Returns once it has ended, after
    // at most two seconds.
    void dismiss();

private:
    RelayGuard(std::filesystem::path site, drivers::FileHandle text, std::vector<int> held, std::string bank)
        : site_(std::move(site)), text_(std::move(text)), held_(std::move(held)), bank_(std::move(bank)) {}
    const std::filesystem::path site_;
    const drivers::FileHandle text_;  // the site's, in memory
    const std::vector<int> held_;
    const std::string bank_;    // "": all
    mutable std::mutex mutex_;  // of:
    drivers::FileHandle pipe_;
    int process_ = -1;
    bool armed_ = false, dismissed_ = false;
};

}  // namespace fantascope::app
