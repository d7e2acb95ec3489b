#pragma once

#include "drivers/common/file_handle.h"

#include "show/site.h"

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

// The subcommand that a RelayGuard starts. It is not for people, so no help names it.
constexpr const char* kGuardCommand = "guard-relays";
// What a run that has ended in order leaves in the guard's pipe.
constexpr std::string_view kAllIsSafe = "safe\n";

// A small process of this program that outlives a run
// (docs/decisions/0030-a-guard-outlives-the-run.md): when the run ends without a word, whatever
// ended it, the guard writes the safe states of the site's relays until every bank has confirmed
// them, for kPatience at most.
// Thread: thread-safe.
class RelayGuard {
public:
    static constexpr Time kPatience = std::chrono::seconds(30);

    // Starts it. The guard reads the site as the run has read it, whatever the file says meanwhile,
    // and keeps `held` (files of claims) open until it ends. Of one `bank` alone, where it is
    // named. Error: no process can be started.
    static Result<std::unique_ptr<RelayGuard>> start(const show::Site& site, std::vector<int> held, std::string bank = {});
    // Unless it was armed, nothing was switched and it is dismissed; an armed one sets to work.
    ~RelayGuard();
    RelayGuard(const RelayGuard&) = delete;
    RelayGuard& operator=(const RelayGuard&) = delete;

    // From now on relays may be unsafe.
    void arm();
    bool hasDied() const;
    // Another one in its place. Error: as start().
    Result<void> restart();
    // The relays are safe: it ends, and with it its hold on the claims. Returns once it has, after
    // two seconds at the latest.
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
