#pragma once

#include "device/status.h"

#include "core/clock.h"
#include "core/result.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace fantascope {

// A line of bytes in both directions: a serial port, a pseudo-terminal, a scripted far end. In
// order, nothing lost or doubled while Running.
// Thread: bound to the thread of the driver that owns it.
class ByteStream : public Device {
public:
    // Takes up to bytes.size() bytes and returns how many were taken, 0 if the line is full; never
    // waits. Error: not Running.
    virtual Result<std::size_t> write(std::span<const std::uint8_t> bytes) = 0;
    // Fills the front of `bytes` with what has arrived and returns how many; waits at most
    // `patience` for the first byte and then returns 0 if none came. Error: not Running; bytes that
    // arrived before the loss are still given first.
    virtual Result<std::size_t> read(std::span<std::uint8_t> bytes, Time patience) = 0;
};

}  // namespace fantascope
