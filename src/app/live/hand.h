#pragma once

#include "app/live/playback_replica.h"
#include "app/site/devices.h"

#include "show/cue_buttons.h"
#include "show/event.h"
#include "show/show.h"
#include "show/show_clock.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// The operator's side of a run: polls the cue controller and the contacts and submits what they say
// as inputs; lights the controller's buttons by what they are good for; puts what became of the
// inputs, and each cue that is entered, among the events.
class Hand {
public:
    // All outlive it, but for the clock; without `devices`' controller or contacts it does without.
    Hand(const show::Show& show, show::InputLog& inputs, const show::Site& site, Devices& devices,
         const show::ShowClock& showClock, show::EventLog& events);

    // How often both are asked: a press waits 5 ms at most.
    static constexpr double kRate = 200;
    void tick(Time moment);

    // Called on the input thread with buttons that set the outputs up.
    std::function<void(show::Button, bool pressed)> edit = [](show::Button, bool) {};
    // Asked on the input thread: whether they do so now.
    std::function<bool()> editing = [] { return false; };

private:
    ButtonLight lightOf(show::Button button, Time showTime) const;
    void light(Time showTime);

    const show::Show& show_;
    const show::Site& site_;
    Devices& devices_;
    const show::ShowClock showClock_;
    show::EventLog& events_;
    show::CueButtons buttons_;
    show::InputLog& inputs_;
    PlaybackReplica replica_;
    show::InputLog::Reader outcomes_;
    show::ShowState state_;
    std::vector<ButtonLight> lights_;  // of Site::buttons, as the controller was told
    int cue_ = -1;
    bool blackout_ = false;
};

}  // namespace fantascope::app
