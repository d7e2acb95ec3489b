#pragma once

#include "device/status.h"

#include "core/result.h"

#include <cstddef>
#include <vector>

namespace fantascope {

// A bank of relays, such as the coils of a Modbus module; true is energised. Thread: bound to the
// relay thread of this bank. A bus may be slow: a call may take up to the driver's timeout, never
// more.
//
// Relays that differ from the last write() (the module lost power for a moment, somebody switched
// them by hand) count as a loss, once, although the bank stays Running. The driver writes nothing
// by itself; the caller may write again. A difference that is undone before the driver reads it may
// go unnoticed. Before the first write() after a loss there is nothing to compare with.
class RelayBank : public Device {
public:
    // How many relays; from the site file, constant.
    virtual std::size_t size() const = 0;
    // Sets all relays; states.size() == size(). Success: the device has confirmed it.
    // Error: not Running or not confirmed. Some, all or no relays may have changed; write again
    // once it is Running.
    // Loss: when the device notices that we are gone (by its own watchdog), every relay takes its
    // safe state and keeps it until the next write(), even after the return. Every driver's
    // destructor writes the safe states if it can, unless the bank was never written to.
    virtual Result<void> write(const std::vector<bool>& states) = 0;
    // The relays' states as read from the device; size() values. Error: as write().
    virtual Result<std::vector<bool>> read() = 0;
};

}  // namespace fantascope
