#include "app/lighting.h"

#include "show/patch.h"

#include <array>
#include <memory>

namespace fantascope::app {

Lighting::Lighting(const show::Site& site, const show::CueList& cues, Devices& devices, const Clock& clock, Time start,
                   Recording* recording)
    : site_(site),
      devices_(devices),
      clock_(clock),
      start_(start),
      recording_(recording),
      replica_(cues),
      wanted_(show::safeCoils(site)) {}

void Lighting::tick(Time moment) {
    const Time showTime = moment - start_;
    replica_.stateAt(showTime, state_);
    for (Devices::Line& line : devices_.lines) {
        std::array<std::uint8_t, kDmxSlots> slots;
        show::slotsOf(site_, state_, line.universe, slots);
        // A line that is not there says so in its status and comes back by itself; the newest levels go out at the next tick.
        if (line.port->send(slots) && recording_ != nullptr) recording_->lighting(showTime, line.universe, slots);
    }
    const Time now = clock_.now();
    if (lastTick_) dmxInterval_.add(now - *lastTick_);
    lastTick_ = now;
    wanted_.writable() = show::coilsOf(site_, state_);
    wanted_.publish();
}

void Lighting::relayTick(Time moment) {
    if (!devices_.relayBank) return;
    wanted_.update();
    const int losses = devices_.relayBank->status().losses;
    if (losses != losses_) written_.clear();  // they took their safe states while the bank was gone
    losses_ = losses;
    if (wanted_.value() == written_) return;
    if (!devices_.relayBank->write(wanted_.value())) {
        written_.clear();
        return;
    }
    written_ = wanted_.value();
    if (recording_ != nullptr) recording_->relays(moment - start_, written_);
}

}  // namespace fantascope::app
