#pragma once

#include "app/devices.h"
#include "app/durations.h"
#include "app/part.h"
#include "app/playback_replica.h"
#include "app/recording.h"

#include "show/dmx_merge.h"
#include "show/site.h"

#include "core/latest_value.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fantascope::app {

// The lamps and the relays: at every tick the show's levels go out on every universe, merged with those of a desk that may take it over, and
// its relays to their banks whenever they change, or a bank was lost or refused. A line or a bank that is lost does not stop the others.
class Lighting {
public:
    // All outlive it; `recording` may be null. Show time 0 is `start` on the clock.
    Lighting(const show::Site& site, const show::CueList& cues, Devices& devices, const Clock& clock, Time start,
             Recording* recording);

    // DMX512 allows up to 44 full frames a second; this leaves the line some rest (ANSI E1.11).
    static constexpr double kRate = 40;
    PlaybackReplica& replica() { return replica_; }
    void tick(Time moment);  // the lighting part's work, at kRate
    // A part for each bank of relays. A call of a slow or dead bank takes as long as its driver's time-out, so each has
    // a thread of its own, and none waits for another.
    std::vector<Part> relayParts();

    // Called on the lighting thread with a sentence for the operator: who is in charge of a universe.
    std::function<void(const std::string&)> tell = [](const std::string&) {};

    // Once both parts have ended.
    const Durations& dmxInterval() const { return dmxInterval_; }

private:
    using Coils = std::vector<bool>;
    // What one bank is to be and is. Made once, since threads share it.
    struct Bank {
        explicit Bank(const Coils& safe) : wanted(safe) {}
        LatestValue<Coils> wanted;  // from the lighting part to the bank's
        Coils written;              // confirmed by the bank; empty: nothing yet, or lost since
        int losses = 0;
    };
    // A universe that somebody else may send too.
    struct Shared {
        show::DmxMerge merge;
        std::vector<std::string> inCharge{""};  // as the operator knows it: at first the show
    };
    void relayTick(std::size_t bank, Time moment);
    void mergeWithDesk(Devices::Line& line, Shared& shared, Time now, std::span<std::uint8_t, kDmxSlots> slots);
    const show::Site& site_;
    Devices& devices_;
    const Clock& clock_;
    const Time start_;
    Recording* recording_;
    PlaybackReplica replica_;
    show::ShowState state_;
    std::vector<std::optional<Shared>> shared_;  // of each line
    std::optional<Time> lastTick_;
    Durations dmxInterval_;
    std::deque<Bank> banks_;  // of Site::relayBanks
};

}  // namespace fantascope::app
