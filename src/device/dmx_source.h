#pragma once

#include "device/dmx_port.h"
#include "device/status.h"

#include "core/clock.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace fantascope {

// One frame from another lighting desk.
struct DmxInput {
    std::array<std::uint8_t, kDmxSlots> slots{};
    std::string source;  // identifies the sender while it sends: a CID, an address, a widget's serial number
    int priority = 100;  // 0 .. 200 as in E1.31; 100 where the protocol has none
    Time arrived{};      // on the clock that open() was handed
    bool ended = false;  // the sender terminated its stream: it is gone, and its slots mean nothing
    // How long a sender may be silent before it counts as gone, by its protocol; E1.31's value if
    // the protocol has none. > 0.
    Time silence = std::chrono::milliseconds(2500);
};

// Receives one DMX512 universe. Thread: bound to the lighting thread.
class DmxSource : public Device {
public:
    // The next frame that was not taken yet, oldest first; senders may alternate. Never waits.
    // Nothing if there is none or the device is lost: a merge detects a missing sender by the
    // absence of frames. Frames from before a loss are dropped. If nobody takes frames, older ones
    // may be dropped, but never the newest of a sender; a termination counts as one.
    virtual std::optional<DmxInput> receive() = 0;
};

}  // namespace fantascope
