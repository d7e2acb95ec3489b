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
    Time at{};              // when it was noticed, on the clock that open() was handed
    bool witnessed = true;  // false: nobody saw it move; at the first look after the start or a loss it was found so
};

// A bank of contacts. Thread: bound to the input thread.
class InputBank : public Device {
public:
    virtual std::size_t size() const = 0;
    // The next change, oldest first; nothing when there is none. Never waits. Changes of one
    // contact alternate: closed, open, closed; a contact that is closed at the start is the first
    // change. A contact that opens and closes between two looks at it may go unnoticed. A loss is
    // no change: nothing is reported for it, and after the return only what really differs from the
    // last report.
    virtual std::optional<ContactChange> poll() = 0;
};

}  // namespace fantascope
