#pragma once

#include "device/status.h"

#include "core/result.h"

#include <cstddef>
#include <vector>

namespace fantascope {

// A bank of relays, such as the coils of a Modbus module; true is energised. Thread: bound to the
// relay thread of this bank (a bus may be slow: a call may take up to the driver's declared
// time-out, never more).
//
// Relays that are found other than the last write() left them (the module was without power for a
// moment, somebody switched them by hand) are a loss too, though the bank goes on Running: it is
// counted once, the driver writes nothing by itself, and who wants them otherwise writes again.
// What was undone before the driver looked may go unnoticed, and before the first write() after a
// loss there is nothing to compare with.
class RelayBank : public Device {
public:
    // How many relays, known from the site file and constant.
    virtual std::size_t size() const = 0;
    // Sets all relays; states.size() == size(). Success means that the device has confirmed it.
    // Error: not Running or not confirmed: some, all or none may have changed; write again once it
    // is Running. Loss: when the device notices that we are gone (its own watchdog), every relay
    // takes its safe state and keeps it, after the return too, until the next write(). The
    // destructor of every driver writes the safe states if it still can; that of a bank which was
    // never written to writes nothing.
    virtual Result<void> write(const std::vector<bool>& states) = 0;
    // What the device says its relays are now; size() values. Error: as write().
    virtual Result<std::vector<bool>> read() = 0;
};

}  // namespace fantascope
