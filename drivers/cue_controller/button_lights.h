#pragma once

#include "device/cue_controller.h"

#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::drivers {

// What the buttons are to show, between who says it and the device that takes its time: the newest
// light of each button wins.
// Thread: tell() from the input thread, everything else from the device's.
class ButtonLights {
public:
    // Whether there is something to show now that was not there before.
    bool tell(int button, const ButtonLight& light);

    // The device shows nothing of all this yet: whatever was told is shown, then the others of its
    // `lamps` first buttons go off.
    void restart(int lamps);
    // The button that has waited longest to show something else, and what. It counts as shown from
    // now on.
    std::optional<std::pair<int, ButtonLight>> next();
    // The buttons that show something.
    std::vector<int> lit() const;

private:
    mutable std::mutex mutex_;
    std::map<int, ButtonLight> told_, shown_;
    std::deque<int> due_;  // each once
};

}  // namespace fantascope::drivers
