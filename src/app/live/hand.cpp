#include "app/live/hand.h"

#include "show/names.h"
#include "show/play/contact_inputs.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <string_view>
#include <tuple>
#include <utility>

namespace fantascope::app {
namespace {

// The labels of the buttons, in the order of show::Button.
constexpr std::array<std::string_view, 18> kWords = {"GO",      "BACK",   "DARK", "PAUSE",   "FREEZE", "PANIC",
                                                     "RESTORE", "EDIT",   "LEFT", "RIGHT",   "UP",     "DOWN",
                                                     "NEXT",    "OUTPUT", "TOOL", "PICTURE", "UNDO",   "WRITE"};
static_assert(kWords.size() == static_cast<std::size_t>(show::Button::Write) + 1);

}  // namespace

Hand::Hand(const show::PlayedShow& show, show::InputLog& inputs, const show::Site& site, Devices& devices,
           const show::ShowClock& showClock, show::EventLog& events)
    : show_(show),
      site_(site),
      devices_(devices),
      showClock_(showClock),
      events_(events),
      sides_(show::namesOf(show.at(0).show.sides)),
      buttons_(site.buttons, sides_),
      inputs_(inputs),
      replica_(inputs),
      outcomes_(inputs.reader()) {
    lights_.resize(site.buttons.size());
    while (outcomes_.next() != nullptr) continue;  // of an earlier run: no news
}

void Hand::tick(Time moment) {
    lateness_.look(moment);
    const auto submit = [&](std::optional<show::Input> input, Time at) {
        if (!input) return;
        input->late = lateness_.isLate(at);
        inputs_.submit(*input);
    };
    while (devices_.cueController) {
        const auto event = devices_.cueController->poll();
        if (!event) break;
        submit(buttons_.inputFor(event->button, event->pressed, showClock_.showTime(event->at)), event->at);
        for (const show::SiteButton& button : site_.buttons)
            if (button.number == event->button && button.button >= show::Button::Edit) edit(button.button, event->pressed);
    }
    for (std::size_t bank = 0; bank < devices_.contactBanks.size(); ++bank)
        while (const auto change = devices_.contactBanks[bank]->poll())
            submit(show::inputFor(site_, bank, change->contact, change->closed, change->witnessed,
                                  showClock_.showTime(change->at), sides_),
                   change->at);
    const Time showTime = showClock_.showTime(moment);
    inputs_.foresee(showTime);
    while (const show::LoggedInput* const logged = outcomes_.next())
        events_.append({showTime, show::event::InputDecided{*logged}});
    replica_.stateAt(showTime, state_);
    light(showTime);
    tell(showTime);
}

// What has changed since the last tick, as events.
void Hand::tell(Time showTime) {
    for (std::size_t i = 0; i < std::size(show::kHolds); ++i)
        if (const auto on = show::kHolds[i].on; told_.*on != state_.*on)
            events_.append({showTime, show::event::HoldChanged{static_cast<show::Hold>(i), state_.*on}});
    if (told_.master != state_.master) events_.append({showTime, show::event::MasterChanged{state_.master}});
    tellByHand(showTime);
    tellCues(showTime, {told_.cue, told_.loaded}, {state_.cue, state_.loaded}, 0);
    told_.sides.resize(state_.sides.size());
    for (std::size_t side = 0; side < state_.sides.size(); ++side)
        tellCues(showTime, told_.sides[side], state_.sides[side], static_cast<int>(side) + 1);
    told_ = state_;
    toldRevision_ = state_.revision;
}

// What the operator has done to single lamps and relays.
void Hand::tellByHand(Time showTime) {
    const auto nameOf = [&](int fixture) {
        return fixture < 0 ? std::string() : site_.fixtures[static_cast<std::size_t>(fixture)].name;
    };
    const auto focus = [](const show::Controls& now) { return std::tuple(now.highlight, now.solo, now.highlightLevel); };
    if (focus(told_) != focus(state_))
        events_.append({showTime, show::event::LampHighlighted{nameOf(state_.highlight), state_.solo, state_.highlightLevel}});
    for (int fixture = 0; fixture < static_cast<int>(site_.fixtures.size()); ++fixture) {
        const auto isParked = [&](const show::Controls& now) { return std::ranges::binary_search(now.parked, fixture); };
        if (isParked(told_) != isParked(state_))
            events_.append({showTime, show::event::LampParked{nameOf(fixture), isParked(state_)}});
        const auto levelOf = [&](const show::Controls& now) {
            const auto raised = std::ranges::find(now.raised, fixture, &show::RaisedLamp::fixture);
            return raised == now.raised.end() ? 0.0f : raised->level;
        };
        if (levelOf(told_) != levelOf(state_))
            events_.append({showTime, show::event::LampRaised{nameOf(fixture), levelOf(state_)}});
    }
    for (int relay = 0; relay < static_cast<int>(site_.relays.size()); ++relay) {
        const auto isOn = [&](const show::Controls& now) {
            const auto found = std::ranges::find(now.switched, relay, &show::SwitchedRelay::relay);
            return found == now.switched.end() ? std::nullopt : std::optional(found->on);
        };
        const std::string& name = site_.relays[static_cast<std::size_t>(relay)].name;
        if (isOn(told_) != isOn(state_)) events_.append({showTime, show::event::RelaySwitched{name, isOn(state_)}});
    }
}

// What has changed in a list.
void Hand::tellCues(Time showTime, show::ListPlace told, const show::ListPlace& now, int list) {
    const std::vector<show::Cue>& cues = show_.at(state_.revision).show.cuesOf(list);
    if (toldRevision_ != state_.revision) {  // the cue of the same name is the same, whatever its number
        const std::vector<show::Cue>& before = show_.at(toldRevision_).show.cuesOf(list);
        const auto isSame = [&](int one, int other) {
            return one >= 0 && other >= 0 &&
                   before[static_cast<std::size_t>(one)].name == cues[static_cast<std::size_t>(other)].name;
        };
        if (isSame(told.cue, now.cue)) told.cue = now.cue;
        if (isSame(told.loaded, now.loaded)) told.loaded = now.loaded;
    }
    // News of a cue by its number; -1: of none.
    const auto named = [&](auto news, int cue) {
        if (list > 0) news.list = sides_[static_cast<std::size_t>(list) - 1];
        news.cue = cue;
        news.cues = static_cast<int>(cues.size());
        if (cue < 0) return news;
        news.name = cues[static_cast<std::size_t>(cue)].name;
        news.number = cues[static_cast<std::size_t>(cue)].number;
        return news;
    };
    if (told.cue != now.cue) events_.append({showTime, named(show::event::CueEntered(), now.cue)});
    if (told.loaded != now.loaded && (now.loaded >= 0 || told.cue == now.cue))
        events_.append({showTime, named(show::event::CueLoaded(), now.loaded)});
}

ButtonLight Hand::lightOf(const show::SiteButton& button, Time showTime) const {
    const int list = show::listNamed(button.list, sides_);
    const show::ListPlace place = list > 0    ? state_.sides[static_cast<std::size_t>(list) - 1]
                                  : list == 0 ? show::ListPlace{state_.cue, state_.loaded, state_.next}
                                              : show::ListPlace{};
    using State = ButtonLight::State;
    const auto lit = [&](bool on, State state) { return on ? state : State::Off; };
    const auto state = [&] {
        switch (button.button) {
            case show::Button::Go:
                if (list >= 0 && replica_.playback().fadesAt(showTime, list)) return State::Active;
                return lit(!state_.locked && !state_.panic && (place.next || (state_.paused && list >= 0)), State::Ready);
            case show::Button::Back:
                return lit(!state_.locked && !state_.panic && place.cue > 0, State::Ready);
            case show::Button::Blackout:
                return lit(state_.blackout, State::Alarm);
            case show::Button::Pause:
                return lit(state_.paused, State::Alarm);
            case show::Button::Freeze:
                return lit(state_.frozen, State::Alarm);
            case show::Button::Panic:
                return lit(state_.panic, State::Alarm);
            case show::Button::Restore:
                return lit(state_.panic, State::Ready);
            case show::Button::Edit:
                return lit(editing(), State::Active);
            default:  // the other buttons are for setting up only
                return lit(editing(), State::Ready);
        }
    };
    return {state(), std::string(kWords[static_cast<std::size_t>(button.button)])};
}

void Hand::light(Time showTime) {
    if (!devices_.cueController) return;
    for (std::size_t i = 0; i < site_.buttons.size(); ++i) {
        ButtonLight light = lightOf(site_.buttons[i], showTime);
        if (light == lights_[i]) continue;
        devices_.cueController->light(site_.buttons[i].number, light);
        lights_[i] = std::move(light);
    }
}

}  // namespace fantascope::app
