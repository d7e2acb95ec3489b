#pragma once

#include "app/live/fault_log.h"
#include "app/live/playback_replica.h"
#include "app/live/run_report.h"
#include "app/site/devices.h"

#include "show/cue_buttons.h"
#include "show/show.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// The operator's side of a run: polls the cue controller and the contacts and submits what they say
// as inputs; lights the controller's buttons by what they are good for; tells which cue is on and
// which inputs are ignored.
class Hand {
public:
    // All outlive it; without `devices`' controller or contacts it does without. Show time 0 is
    // `start` on the clock.
    Hand(const show::Show& show, show::InputLog& inputs, const show::Site& site, Devices& devices, Time start);

    // How often both are asked: a press waits 5 ms at most.
    static constexpr double kRate = 200;
    void tick(Time moment);

    // Called on the input thread with a sentence whenever an input or a cue change is worth telling
    // the operator.
    std::function<void(const std::string&)> tell = [](const std::string&) {};

    // Called on the input thread with buttons that set the outputs up.
    std::function<void(show::Button, bool pressed)> edit = [](show::Button, bool) {};
    // Asked on the input thread: whether they do so now.
    std::function<bool()> editing = [] { return false; };

    // Once the input part has ended.
    const std::vector<CueReport>& cues() const { return entered_; }

private:
    ButtonLight lightOf(show::Button button, Time showTime) const;
    void light(Time showTime);

    const show::Show& show_;
    const show::Site& site_;
    Devices& devices_;
    const Time start_;
    show::CueButtons buttons_;
    show::InputLog& inputs_;
    PlaybackReplica replica_;
    show::InputLog::Reader outcomes_;
    show::ShowState state_;
    std::vector<CueReport> entered_;
    std::vector<ButtonLight> lights_;  // of Site::buttons, as the controller was told
    int cue_ = -1;
    bool blackout_ = false;
};

// When a rehearsal without hands presses GO, so that it reaches every cue in an equal share of its
// length: one press for each cue that is to be entered. The first comes after a moment of darkness,
// or, where a cue is on from the start, after that cue's share.
class GoSchedule {
public:
    GoSchedule(std::size_t presses, bool cueIsOn, Time length) : presses_(presses), cueIsOn_(cueIsOn), length_(length) {}
    // Whether the next press is due; each is so once.
    bool due(Time showTime);
    // The show time of the next press; Time::max() if none is to come.
    Time next() const;
    void end() { pressed_ = presses_; }  // the operator has taken over
    bool ended() const { return pressed_ == presses_; }

private:
    std::size_t presses_, pressed_ = 0;
    bool cueIsOn_;
    Time length_;
};

}  // namespace fantascope::app
