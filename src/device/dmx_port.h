#pragma once

#include "device/status.h"

#include "core/result.h"

#include <cstdint>
#include <span>

namespace fantascope {

// The slots of one DMX512 universe (ANSI E1.11): slot 0 here is the standard's slot 1, a lamp's
// "address 1". 0 .. 255.
inline constexpr std::size_t kDmxSlots = 512;

// One DMX512 universe going out. Thread: bound to the lighting thread.
class DmxPort : public Device {
public:
    // Hands over one whole frame. Never waits; a newer frame replaces an unsent one; the line
    // repeats the newest by itself for as long as it runs. Error: not Running: the frame is
    // dropped, and after the device's return the next send() is what goes out.
    // The newest frame goes out before the destructor returns, if the line is there.
    // Loss: the line falls silent and the lamps do what they do then: most hold.
    virtual Result<void> send(std::span<const std::uint8_t, kDmxSlots> slots) = 0;
};

}  // namespace fantascope
