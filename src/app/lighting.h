#pragma once

#include "app/devices.h"
#include "app/durations.h"
#include "app/part.h"
#include "app/playback_replica.h"
#include "app/recording.h"

#include "show/site.h"

#include "core/latest_value.h"

#include <optional>
#include <vector>

namespace fantascope::app {

// The lamps and the relays: at every tick the show's levels go out on every universe, and its relays to the bank whenever they change, or
// the bank was lost or refused. A line that is lost does not stop the others.
class Lighting {
public:
    // All outlive it; `recording` may be null. Show time 0 is `start` on the clock.
    Lighting(const show::Site& site, const show::CueList& cues, Devices& devices, const Clock& clock, Time start,
             Recording* recording);

    // DMX512 allows up to 44 full frames a second; this leaves the line some rest (ANSI E1.11).
    static constexpr double kRate = 40;
    PlaybackReplica& replica() { return replica_; }
    void tick(Time moment);       // the lighting part's work, at kRate
    void relayTick(Time moment);  // the relay part's work; a bus may be slow, so it has a thread of its own

    // Once both parts have ended.
    const Durations& dmxInterval() const { return dmxInterval_; }

private:
    using Coils = std::vector<bool>;
    const show::Site& site_;
    Devices& devices_;
    const Clock& clock_;
    const Time start_;
    Recording* recording_;
    PlaybackReplica replica_;
    show::ShowState state_;
    std::optional<Time> lastTick_;
    Durations dmxInterval_;
    LatestValue<Coils> wanted_;  // from the lighting part to the relay part
    Coils written_;              // confirmed by the bank; empty: nothing yet, or lost since
    int losses_ = 0;
};

}  // namespace fantascope::app
