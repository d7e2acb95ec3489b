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

// Tries one device in a way that a person on a ladder can see: one fixture after the other, a
// click, a press, a picture. Each trial waits for the device, and resumes when a lost device is
// back. Error: the device was never there, or it did something else than it was told. Thread: the
// port's.
class DeviceTrial {
public:
    // The site's names for slots, coils, buttons or inputs. One without a name is called by its
    // number.
    using Names = std::map<std::size_t, std::string>;

    // All outlive it. A trial ends after `length`, or when interrupted. It prints a line to `out`
    // for each thing to be seen.
    DeviceTrial(Clock& clock, Time length, const Interrupt* interrupt, std::ostream& out)
        : clock_(clock), end_(clock.now() + length), interrupt_(interrupt), out_(out) {}

    // Lights these slots (0 .. 511) one after the other, again and again, with the others dark. All
    // are dark at the end.
    Result<void> chase(DmxPort& port, const std::vector<std::size_t>& slots, const Names& names = {});
    // Switches each relay to its unsafe state and back, one after the other, and reads the bank
    // back each time. All are safe at the end. With names it switches only relays that have one.
    // `guard`: for real relays; it outlives the bank. Error: also if the bank has not confirmed the
    // safe states at the end.
    Result<void> click(RelayBank& bank, const std::vector<bool>& safeStates, const Names& names = {},
                       RelayGuard* guard = nullptr);
    // Prints every button that is pressed or released, and every contact that changes.
    Result<void> tellPresses(CueController& controller, const Names& names = {});
    Result<void> tellContacts(InputBank& bank, const Names& names = {});
    // Prints who sends, and which slots change.
    Result<void> tellDesk(DmxSource& source, const Names& names = {});
    // Writes the first picture to a PNG file; prints its size, its brightness and the frame rate.
    Result<void> snapshot(CameraSource& camera, const std::filesystem::path& file);

private:
    // False also if nobody reads `out` any more.
    bool goesOn() const { return clock_.now() < end_ && out_.good() && (interrupt_ == nullptr || !interrupt_->requested()); }
    // Calls `step` every `period` while the device is there. Error: it never was there, or that of
    // `step`.
    Result<void> every(Time period, const Device& device, const std::function<Result<void>()>& step);

    Clock& clock_;
    const Time end_;
    const Interrupt* interrupt_;
    std::ostream& out_;
};

}  // namespace fantascope::app
