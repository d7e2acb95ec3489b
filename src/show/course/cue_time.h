#pragma once

#include "show/course/steps.h"

#include "core/clock.h"

#include <optional>

namespace fantascope::show {

// The time by which cues play: show time without what was paused of it. Waits, fades, follows,
// videos, shadows and the sway of patterns go by it. A pure function of show time and of the calls
// so far, whose times never decrease. Thread: const functions are reentrant.
class CueTime {
public:
    // From show time `at` on, cue time stands still or goes on. If it does so already, nothing
    // changes. It goes on with the next nanosecond, so that what happens then happens after all
    // that was seen in the pause.
    void stand(Time at);
    void goOn(Time at);
    // Lets cue time that stands still do so at the next nanosecond, for something that happens in
    // the pause.
    void tick(Time at);

    // Cue time at a show time. It never decreases.
    Time at(Time showTime) const;
    bool standsAt(Time showTime) const { return parts_.at(showTime).standsAt.has_value(); }
    // Forgets what was before a show time.
    void forget(Time showTime) { parts_.forget(showTime); }

private:
    struct Part {
        Time paused{};                 // so far
        std::optional<Time> standsAt;  // cue time; nothing: it goes on
    };
    Steps<Part> parts_;
};

}  // namespace fantascope::show
