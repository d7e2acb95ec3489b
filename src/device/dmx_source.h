#pragma once

#include "device/dmx_port.h"
#include "device/status.h"

#include "core/clock.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace fantascope {

// One frame from somebody else's desk.
struct DmxInput {
    std::array<std::uint8_t, kDmxSlots> slots{};
    std::string source;  // the sender, stable while it sends: a CID, an address, a widget's serial number
    int priority = 100;  // 0 .. 200 as in E1.31; 100 where the protocol has none
    Time arrived{};      // on the clock that open() was handed
    bool ended = false;  // the sender said goodbye: it is gone now, and its slots mean nothing
    // How long its protocol lets a sender be silent before it counts as gone; as in E1.31 where the
    // protocol says nothing. > 0.
    Time silence = std::chrono::milliseconds(2500);
};

// One DMX512 universe coming in. Thread: bound to the lighting thread.
class DmxSource : public Device {
public:
    // The next frame that arrived and was not taken yet, oldest first; several senders may
    // alternate. Never waits. Nothing when there is none, also when the device is lost: the absence
    // of frames is what a merge times out on. A frame from before a loss is not given after the
    // return. At least the newest frame of each sender is kept, a goodbye being its newest; older
    // ones may be dropped when nobody takes them.
    virtual std::optional<DmxInput> receive() = 0;
};

}  // namespace fantascope
