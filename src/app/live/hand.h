#pragma once

#include "app/keys/lateness.h"
#include "app/site/devices.h"

#include "show/play/cue_buttons.h"
#include "show/play/event.h"
#include "show/play/playback_replica.h"
#include "show/play/show_clock.h"
#include "show/played_show.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// The operator's side of a run. It polls the hand controller and the contacts, and submits inputs
// for them. It lights each button that has a use at the moment. It logs the outcome of every input,
// and every cue that is entered, as events.
class Hand {
public:
    // All arguments by reference outlive this, except `showClock`. `devices` may lack the hand
    // controller or contacts.
    Hand(const show::PlayedShow& show, show::InputLog& inputs, const show::Site& site, Devices& devices,
         const show::ShowClock& showClock, show::EventLog& events);

    // Hz; the poll rate of both. A press waits at most 5 ms.
    static constexpr double kRate = 200;
    void tick(Time moment);

    // Called on the input thread for the buttons of setting up.
    std::function<void(show::Button, bool pressed)> edit = [](show::Button, bool) {};
    // Called on the input thread: whether the outputs are being set up now.
    std::function<bool()> editing = [] { return false; };

private:
    ButtonLight lightOf(const show::SiteButton& button, Time showTime) const;
    void light(Time showTime);
    void tell(Time showTime);
    void tellByHand(Time showTime);
    void tellCues(Time showTime, show::ListPlace told, const show::ListPlace& now, int list);

    const show::PlayedShow& show_;
    const show::Site& site_;
    Devices& devices_;
    const show::ShowClock showClock_;
    show::EventLog& events_;
    const std::vector<std::string> sides_;  // the names of the show's side lists
    show::CueButtons buttons_;
    Lateness lateness_;
    show::InputLog& inputs_;
    show::PlaybackReplica replica_;
    show::InputLog::Reader outcomes_;
    show::ShowState state_;
    std::vector<ButtonLight> lights_;  // of Site::buttons, as last sent to the controller
    show::Controls told_;              // what the newest events say
    std::uint64_t toldRevision_ = 0;   // that its cues are of
};

}  // namespace fantascope::app
