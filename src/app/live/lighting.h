#pragma once

#include "app/base/durations.h"
#include "app/live/recording.h"
#include "app/live/run_report.h"
#include "app/parts/fault_log.h"
#include "app/parts/part.h"
#include "app/site/devices.h"
#include "drivers/common/back_off.h"

#include "show/play/event.h"
#include "show/play/playback_replica.h"
#include "show/play/show_clock.h"
#include "show/site/dmx_merge.h"
#include "show/site/site.h"

#include "core/latest_value.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fantascope::app {

// The fixtures and the relays. At every tick the show's levels are sent on every universe, merged
// with those of a desk that may take it over. The relays are written to their banks when their
// states change, and again after a bank was lost or refused a write. A line or a bank that is lost
// does not stop the others.
//
// When the show ends, the parts go on: the fixtures fade to the site's end levels, and the relays
// take their safe states.
class Lighting {
public:
    // All arguments by reference outlive this, except `showClock`. `recording` may be null.
    Lighting(const show::Site& site, const show::InputLog& inputs, Devices& devices, const Clock& clock,
             const show::ShowClock& showClock, Recording* recording, FaultLog& faults, show::EventLog& events);

    // Hz. DMX512 allows up to 44 full frames a second (ANSI E1.11); this rate leaves a margin.
    static constexpr double kRate = 40;
    void tick(Time moment);  // the lighting part's work, at kRate
    // A part for each relay bank. A call to a slow or dead bank may last until its driver's
    // timeout, so each bank has a thread of its own, and none waits for another. Relays that do not
    // switch, or that something else switches, are written ever more rarely. A new cue and the end
    // are written at once nevertheless.
    std::vector<Part> relayParts();

    // Ends the show's control at `moment`. Relays take their safe states at once and keep them, and
    // fixtures fade to the site's end levels. A desk keeps the slots that it has. Only the first
    // call has an effect. Thread: any.
    void end(Time moment);
    // Skips the rest of the fade: the next frame has the end levels. Call it after end(). Thread:
    // any.
    void hurry() { hurried_ = true; }
    // Whether every bank has confirmed its safe states, and every line that is there was given the
    // end levels. Thread: any.
    bool ended() const;
    // The banks that have not confirmed their safe states since end(), and why. Thread: any; waits
    // for no device.
    std::vector<UnsafeBank> unsafeBanks() const;
    // The lines that have not taken the end levels since end(), and why. Thread: any; waits for no
    // device.
    std::vector<UnendedLine> unendedLines() const;

    // The intervals between DMX frames. Call it once the lighting part has ended.
    const Durations& dmxInterval() const { return dmxInterval_; }

private:
    static constexpr Time kSoonestRelays = std::chrono::milliseconds(50), kLatestRelays = std::chrono::seconds(5);
    using Coils = std::vector<bool>;
    // The wanted and the actual states of one bank. Threads share it, so it never moves.
    struct Bank {
        LatestValue<Coils> wanted;  // from the lighting part to the bank's part; empty before the show's first moment
        Coils written;              // confirmed by the bank; empty: nothing was confirmed yet, or the bank was lost since
        int losses = 0;
        Coils tried;  // the last write, confirmed or not
        drivers::BackOff backOff{kSoonestRelays, kLatestRelays};
        Time nextTry{}, confirmed{};
        bool isFaulty = false;  // a fault was reported, and the bank has not been right for long enough since
        bool ending = false;
        mutable std::mutex mutex;  // of:
        std::string whyUnsafe;     // empty: the safe states are confirmed
    };
    // A universe that a desk may send, too.
    struct Shared {
        show::DmxMerge merge;
        show::DmxSlots asked{};                 // our own levels, before they are trimmed
        std::vector<std::string> inCharge{""};  // as last reported to the operator; at first the show
    };
    void relayTick(std::size_t bank, Time moment);
    void confirm(std::size_t bank);  // reads back whether its relays are still as written
    Result<void> bringTo(const Coils& wanted, std::size_t bank, Time moment);
    void takeLoss(std::size_t bank, Time moment);
    void reportRefusal(std::size_t bank, const Error& error, Time moment);
    void reportFault(std::size_t bank, Time moment, const std::string& what);
    void reportRecovery(std::size_t bank, Time moment);
    // Reads back the relays of a bank, and names those that differ from `wanted`: "road-north,
    // road-south"; empty: none differs, or the read failed.
    std::string differing(std::size_t bank, const Coils& wanted);
    void fadeToEnd(double share);  // share of the fade, 0..1
    void mergeWithDesk(Devices::Line& line, Shared& shared, Time now, std::span<std::uint8_t, kDmxSlots> slots);
    const show::Site& site_;
    Devices& devices_;
    const Clock& clock_;
    const show::ShowClock showClock_;
    Recording* recording_;
    FaultLog& faults_;
    show::EventLog& events_;
    show::PlaybackReplica replica_;
    show::ShowState state_;
    std::vector<std::optional<Shared>> shared_;  // by line
    std::optional<Time> lastTick_;
    Durations dmxInterval_;
    std::deque<Bank> banks_;  // of Site::relayBanks
    const std::vector<float> endLevels_;
    std::atomic<Time> endsAt_ = Time::max();
    std::atomic<bool> hurried_ = false, lampsEnded_ = false;
    mutable std::mutex linesMutex_;        // of:
    std::vector<std::string> whyUnended_;  // by line; empty: it has taken the end levels
};

}  // namespace fantascope::app
