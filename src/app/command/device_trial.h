#pragma once

#include "app/base/interrupt.h"
#include "app/site/relay_guard.h"

#include "device/camera_source.h"
#include "device/cue_controller.h"
#include "device/dmx_port.h"
#include "device/dmx_source.h"
#include "device/input_bank.h"
#include "device/relay_bank.h"

#include "core/clock.h"
#include "core/result.h"

#include <filesystem>
#include <functional>
#include <map>
#include <ostream>
#include <string>
#include <vector>

namespace fantascope::app {

// Tries one device, in a way that somebody on a ladder sees: a lamp after the other, a click, a
// press, a picture. Each waits until the device is there, and goes on when it was lost and is back.
// Error: it was not there all the while, or what it did is not what it was told to do. Thread: the
// one that the port is bound to.
class DeviceTrial {
public:
    // What the site calls a slot, a coil, a button or an input; what it does not name goes by its
    // number.
    using Names = std::map<std::size_t, std::string>;

    // All outlive it. It ends after `length`, or when interrupted. `out` is told what is to be
    // seen, a line each.
    DeviceTrial(Clock& clock, Time length, const Interrupt* interrupt, std::ostream& out)
        : clock_(clock), end_(clock.now() + length), interrupt_(interrupt), out_(out) {}

    // Lights one of these slots (0 .. 511) after the other, the others dark, over and over; dark at
    // the end.
    Result<void> chase(DmxPort& port, const std::vector<std::size_t>& slots, const Names& names = {});
    // Switches each relay to its unsafe state and back, one after the other, and asks the bank each
    // time what it did; safe at the end. With names only the relays that have one. The guard, where
    // relays are real, outlives the bank. Error: also that the bank has not confirmed the safe
    // states at the end.
    Result<void> click(RelayBank& bank, const std::vector<bool>& safeStates, const Names& names = {},
                       RelayGuard* guard = nullptr);
    // Tells of every button that goes down or up, and of every contact.
    Result<void> tellPresses(CueController& controller, const Names& names = {});
    Result<void> tellContacts(InputBank& bank, const Names& names = {});
    // Tells who sends, and which slots change.
    Result<void> tellDesk(DmxSource& source, const Names& names = {});
    // Leaves the first picture in a PNG file and tells its size, brightness and how many come a
    // second.
    Result<void> snapshot(CameraSource& camera, const std::filesystem::path& file);

private:
    // Not where nobody reads it any more.
    bool goesOn() const { return clock_.now() < end_ && out_.good() && (interrupt_ == nullptr || !interrupt_->requested()); }
    // Does something every `period` while the device is there. Error: it never was, or what `step`
    // says.
    Result<void> every(Time period, const Device& device, const std::function<Result<void>()>& step);

    Clock& clock_;
    const Time end_;
    const Interrupt* interrupt_;
    std::ostream& out_;
};

}  // namespace fantascope::app
