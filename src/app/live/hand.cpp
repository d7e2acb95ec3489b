#include "app/live/hand.h"

#include "show/contact_inputs.h"

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

namespace fantascope::app {
namespace {

// The labels of the buttons, in the order of show::Button.
constexpr std::array<std::string_view, 14> kWords = {"GO",   "BACK", "DARK",   "EDIT", "LEFT",    "RIGHT", "UP",
                                                     "DOWN", "NEXT", "OUTPUT", "TOOL", "PICTURE", "UNDO",  "WRITE"};
static_assert(kWords.size() == static_cast<std::size_t>(show::Button::Write) + 1);

}  // namespace

Hand::Hand(const show::Show& show, show::InputLog& inputs, const show::Site& site, Devices& devices,
           const show::ShowClock& showClock, show::EventLog& events)
    : show_(show),
      site_(site),
      devices_(devices),
      showClock_(showClock),
      events_(events),
      buttons_(site.buttons),
      inputs_(inputs),
      replica_(inputs),
      outcomes_(inputs.reader()) {
    lights_.resize(site.buttons.size());
}

void Hand::tick(Time moment) {
    while (devices_.cueController) {
        const auto event = devices_.cueController->poll();
        if (!event) break;
        if (const auto input = buttons_.inputFor(event->button, event->pressed, showClock_.showTime(event->at)))
            inputs_.submit(*input);
        for (const auto& [number, button] : site_.buttons)
            if (number == event->button && button >= show::Button::Edit) edit(button, event->pressed);
    }
    for (std::size_t bank = 0; bank < devices_.contactBanks.size(); ++bank)
        while (const auto change = devices_.contactBanks[bank]->poll())
            if (const auto input = show::inputFor(site_, bank, change->contact, change->closed, change->witnessed,
                                                  showClock_.showTime(change->at)))
                inputs_.submit(*input);
    const Time showTime = showClock_.showTime(moment);
    inputs_.foresee(showTime);
    while (const show::LoggedInput* const logged = outcomes_.next())
        events_.append({showTime, show::event::InputDecided{*logged}});
    replica_.stateAt(showTime, state_);
    light(showTime);
    if (std::exchange(blackout_, state_.blackout) != state_.blackout)
        events_.append({showTime, show::event::BlackoutChanged{state_.blackout}});
    if (std::exchange(locked_, state_.locked) != state_.locked)
        events_.append({showTime, show::event::LockChanged{state_.locked}});
    if (state_.cue == cue_) return;
    cue_ = state_.cue;
    const show::Cue& cue = show_.cues[static_cast<std::size_t>(cue_)];
    events_.append({showTime, show::event::CueEntered{cue_, static_cast<int>(show_.cues.size()), cue.name, cue.number}});
}

ButtonLight Hand::lightOf(show::Button button, Time showTime) const {
    using State = ButtonLight::State;
    const auto lit = [&](bool on, State state) { return on ? state : State::Off; };
    const auto state = [&] {
        switch (button) {
            case show::Button::Go:
                if (replica_.playback().fadesAt(showTime)) return State::Active;
                return lit(!state_.locked && replica_.playback().cues().after(state_.cue).has_value(), State::Ready);
            case show::Button::Back:
                return lit(!state_.locked && state_.cue > 0, State::Ready);
            case show::Button::Blackout:
                return lit(state_.blackout, State::Alarm);
            case show::Button::Edit:
                return lit(editing(), State::Active);
            default:  // the other buttons are for setting up only
                return lit(editing(), State::Ready);
        }
    };
    return {state(), std::string(kWords[static_cast<std::size_t>(button)])};
}

void Hand::light(Time showTime) {
    if (!devices_.cueController) return;
    for (std::size_t i = 0; i < site_.buttons.size(); ++i) {
        const auto& [number, button] = site_.buttons[i];
        ButtonLight light = lightOf(button, showTime);
        if (light == lights_[i]) continue;
        devices_.cueController->light(number, light);
        lights_[i] = std::move(light);
    }
}

}  // namespace fantascope::app
