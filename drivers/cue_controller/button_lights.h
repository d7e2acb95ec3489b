#pragma once

#include "device/cue_controller.h"

#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::drivers {

// The wanted light of each button, between the input thread and a device that takes its time. The
// newest light of a button wins.
// Thread: set() from the input thread, everything else from the device's thread.
class ButtonLights {
public:
    // Returns whether the light differs from the one before.
    bool set(int button, const ButtonLight& light);

    // The device shows nothing any more. All wanted lights become due, then the remaining ones of
    // the first `lamps` buttons, to switch them off.
    void invalidate(int lamps);
    // The button whose change has waited longest, and its light, which counts as shown from now on.
    std::optional<std::pair<int, ButtonLight>> next();
    // The buttons that are lit.
    std::vector<int> lit() const;

private:
    mutable std::mutex mutex_;
    std::map<int, ButtonLight> wanted_, shown_;
    std::deque<int> due_;  // each button once
};

}  // namespace fantascope::drivers
