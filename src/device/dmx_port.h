#pragma once

#include "device/status.h"

#include "core/result.h"

#include <cstdint>
#include <span>

namespace fantascope {

// The slots of a DMX512 universe (ANSI E1.11), 0 .. 255 each. Index 0 is the standard's slot 1, a
// lamp's "address 1".
inline constexpr std::size_t kDmxSlots = 512;

// Sends one DMX512 universe. Thread: bound to the lighting thread.
class DmxPort : public Device {
public:
    // Sends a whole frame. Never waits; a newer frame replaces an unsent one. The line repeats the
    // newest frame by itself while it is Running. Error: not Running; the frame is dropped, and
    // after the return nothing is sent until the next send().
    // The destructor sends the newest frame first, if the line is there.
    // Loss: the line falls silent. What the lamps do then is up to them; most hold.
    virtual Result<void> send(std::span<const std::uint8_t, kDmxSlots> slots) = 0;
};

}  // namespace fantascope
