#pragma once

#include "device/status.h"

#include "core/clock.h"
#include "core/result.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace fantascope {

// A bidirectional byte stream: a serial port, a pseudo-terminal, a scripted far end. While Running,
// bytes arrive in order, none lost or doubled.
// Thread: bound to the thread of the driver that owns it.
class ByteStream : public Device {
public:
    // Accepts up to bytes.size() bytes and returns how many; 0 if the line is full. Never waits.
    // Error: not Running.
    virtual Result<std::size_t> write(std::span<const std::uint8_t> bytes) = 0;
    // Fills the front of `bytes` with what has arrived and returns how many. Waits up to `timeout`
    // for the first byte; returns 0 if none came. Error: not Running, once the bytes that arrived
    // before the loss are read.
    virtual Result<std::size_t> read(std::span<std::uint8_t> bytes, Time timeout) = 0;
};

}  // namespace fantascope
