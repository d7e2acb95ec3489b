#pragma once

#include "device/status.h"

#include "core/clock.h"

#include <cstddef>
#include <optional>

namespace fantascope {

// A contact that changed: a door, an emergency button.
struct ContactChange {
    std::size_t contact = 0;
    bool closed = false;
    Time at{};              // when the driver saw it, on the clock that open() was handed
    bool witnessed = true;  // false: it was found so at the first reading after the start or a loss
};

// A bank of contacts. Thread: bound to the input thread.
class InputBank : public Device {
public:
    virtual std::size_t size() const = 0;
    // The next change, oldest first; nothing if there is none. Never waits. The changes of a
    // contact alternate: closed, open, closed. A contact that is closed at the start is reported
    // closed. A contact that opens and closes between two readings may go unnoticed. A loss is not
    // a change: nothing is reported for it, and after the return only contacts that differ from the
    // last report are reported.
    virtual std::optional<ContactChange> poll() = 0;
};

}  // namespace fantascope
