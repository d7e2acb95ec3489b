#pragma once

#include "device/status.h"

#include "core/result.h"

#include <cstddef>
#include <vector>

namespace fantascope {

// A bank of relays, such as the coils of a Modbus module; true is energised. Thread: bound to the relay thread of this bank (a
// bus may be slow: a call may take up to the driver's declared time-out, never more).
class RelayBank : public Device {
public:
    // How many relays, known from the site file and constant.
    virtual std::size_t size() const = 0;
    // Sets all relays; states.size() == size(). Success means that the device has confirmed it. Error: not Running or not
    // confirmed: some, all or none may have changed; write again once it is Running. Loss: when the device notices that we are
    // gone (its own watchdog), every relay takes its safe state and keeps it, after the return too, until the next write(). The
    // destructor of every driver writes the safe states if it still can.
    virtual Result<void> write(const std::vector<bool>& states) = 0;
    // What the device says its relays are now; size() values. Error: as write().
    virtual Result<std::vector<bool>> read() = 0;
};

}  // namespace fantascope
