#pragma once

#include "app/base/durations.h"
#include "app/live/fault_log.h"
#include "app/live/part.h"
#include "app/live/playback_replica.h"
#include "app/live/recording.h"
#include "app/site/devices.h"
#include "drivers/common/back_off.h"

#include "show/event.h"
#include "show/show_clock.h"
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

// The lamps and the relays: at every tick the show's levels go out on every universe, merged with
// those of a desk that may take it over, and its relays to their banks whenever they change, or a
// bank was lost or refused. A line or a bank that is lost does not stop the others.
//
// When the show ends the parts go on: the lamps fade to the site's end levels, the relays take
// their safe states.
class Lighting {
public:
    // All outlive it, but for the show's clock; `recording` may be null.
    Lighting(const show::Site& site, const show::InputLog& inputs, Devices& devices, const Clock& clock,
             const show::ShowClock& showClock, Recording* recording, FaultLog& faults, show::EventLog& events);

    // DMX512 allows up to 44 full frames a second; this leaves the line some rest (ANSI E1.11).
    static constexpr double kRate = 40;
    void tick(Time moment);  // the lighting part's work, at kRate
    // A part for each bank of relays. A call of a slow or dead bank takes as long as its driver's
    // time-out, so each has a thread of its own, and none waits for another. Relays that do not
    // follow, or that somebody else switches, are written ever more rarely, but for a new cue and
    // the end, which are written at once.
    std::vector<Part> relayParts();

    // From `moment` on the show no longer decides: relays take their safe states at once and keep
    // them, lamps fade to the site's end levels. A desk keeps what it has. Only the first call
    // counts. Thread: any.
    void end(Time moment);
    // Nobody waits for the fade any more: with their next frame the lamps are at their end levels.
    // After end(). Thread: any.
    void hurry() { hurried_ = true; }
    // Whether every bank has confirmed its safe states, and the end levels were handed to every
    // line that is there. Thread: any.
    bool ended() const;
    // The banks whose safe states are not confirmed since end(), and why. Thread: any; waits for no
    // device.
    std::vector<UnsafeBank> unsafeBanks() const;
    // The lines that have not taken the end levels since end(), and why. Thread: any; waits for no
    // device.
    std::vector<UnendedLine> unendedLines() const;

    // Once both parts have ended.
    const Durations& dmxInterval() const { return dmxInterval_; }

private:
    static constexpr Time kSoonestRelays = std::chrono::milliseconds(50), kLatestRelays = std::chrono::seconds(5);
    using Coils = std::vector<bool>;
    // What one bank is to be and is. Made once, since threads share it.
    struct Bank {
        LatestValue<Coils> wanted;  // from the lighting part to the bank's; empty before the show's first moment
        Coils written;              // confirmed by the bank; empty: nothing yet, or lost since
        int losses = 0;
        Coils tried;  // what was written last, whether the bank confirmed it or not
        drivers::BackOff backOff{kSoonestRelays, kLatestRelays};
        Time nextTry{}, confirmed{};
        bool isFaulty = false;  // told so, and not for long enough all right since
        bool ending = false;
        mutable std::mutex mutex;  // of:
        std::string whyUnsafe;     // empty: the safe states are confirmed
    };
    // A universe that somebody else may send too.
    struct Shared {
        show::DmxMerge merge;
        std::vector<std::string> inCharge{""};  // as the operator knows it: at first the show
    };
    void relayTick(std::size_t bank, Time moment);
    void confirm(std::size_t bank);  // asks whether its relays still are as written
    Result<void> bringTo(const Coils& wanted, std::size_t bank, Time moment);
    void takeLoss(std::size_t bank, Time moment);
    void reportRefusal(std::size_t bank, const Error& error, Time moment);
    void reportFault(std::size_t bank, Time moment, const std::string& what);
    void reportRecovery(std::size_t bank, Time moment);
    // The relays of a bank that differ from `wanted`, by the bank's own word: "road-north,
    // road-south"; empty: none, or it does not say.
    std::string differing(std::size_t bank, const Coils& wanted);
    void fadeToEnd(double share);  // of the way, 0..1
    void mergeWithDesk(Devices::Line& line, Shared& shared, Time now, std::span<std::uint8_t, kDmxSlots> slots);
    const show::Site& site_;
    Devices& devices_;
    const Clock& clock_;
    const show::ShowClock showClock_;
    Recording* recording_;
    FaultLog& faults_;
    show::EventLog& events_;
    PlaybackReplica replica_;
    show::ShowState state_;
    std::vector<std::optional<Shared>> shared_;  // of each line
    std::optional<Time> lastTick_;
    Durations dmxInterval_;
    std::deque<Bank> banks_;  // of Site::relayBanks
    const std::vector<float> endLevels_;
    std::atomic<Time> endsAt_ = Time::max();
    std::atomic<bool> hurried_ = false, lampsEnded_ = false;
    mutable std::mutex linesMutex_;        // of:
    std::vector<std::string> whyUnended_;  // of each line; empty: it has taken the end levels
};

}  // namespace fantascope::app
