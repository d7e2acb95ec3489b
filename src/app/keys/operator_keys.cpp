#include "app/keys/operator_keys.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {

using Source = show::Input::Source;
using Kind = show::Input::Kind;

namespace {

// A level, some tenths higher.
float stepped(float level, int steps) {
    constexpr float kTenths = 10;
    return std::clamp((std::round(level * kTenths) + static_cast<float>(steps)) / kTenths, 0.0f, 1.0f);
}

// The kind of input that a key gives which needs nothing else.
Kind kindOf(RunKey::Action action) {
    using Action = RunKey::Action;
    constexpr std::pair<Action, Kind> kKinds[] = {
        {Action::Go, Kind::Go},          {Action::Back, Kind::Back},       {Action::Blackout, Kind::Blackout},
        {Action::Pause, Kind::Pause},    {Action::Freeze, Kind::Freeze},   {Action::Panic, Kind::Panic},
        {Action::Lock, Kind::Lock},      {Action::Restore, Kind::Restore}, {Action::Corrections, Kind::Corrections},
        {Action::Release, Kind::Release}};
    return std::ranges::find(kKinds, action, &std::pair<Action, Kind>::first)->second;
}

}  // namespace

OperatorKeys::OperatorKeys(show::InputLog& inputs, show::EventLog& events, const show::ShowClock& showClock,
                           std::unique_ptr<TerminalKeys> terminal, GoSchedule schedule, QuitKey quitKey, Actions actions)
    : inputs_(inputs),
      replica_(inputs),
      others_(inputs.reader()),
      events_(events),
      showClock_(showClock),
      terminal_(std::move(terminal)),
      schedule_(schedule),
      quitKey_(quitKey),
      actions_(std::move(actions)) {}

void OperatorKeys::tick(Time moment) {
    lateness_.look(moment);
    while (const auto character = terminal_ ? terminal_->poll() : std::nullopt)
        if (const auto key = parser_.take(*character)) press(*key, Source::Terminal, moment);
    if (const auto key = parser_.pause(moment)) press(*key, Source::Terminal, moment);
    while (const Press* const pressed = pressedAtScreens_.next()) press(pressed->key, Source::Screen, pressed->moment);
    while (const show::LoggedInput* const logged = others_.next())
        if (logged->input.source == Source::Page) endSchedule(logged->input.at);
    // After a gap its press would be late: the next tick presses.
    if (!lateness_.isLate(moment) && schedule_.due(showClock_.runTime(moment)) && !actions_.pressGo())
        inputs_.submit({.at = showClock_.showTime(moment), .kind = Kind::Go, .source = Source::Schedule});
    nextGo_ = schedule_.next();
}

// A key acts like a button of the hand controller. A key that gives an input ends the schedule.
void OperatorKeys::press(const Key& key, Source source, Time moment) {
    if (actions_.setUp(key)) return;
    const auto action = actionOf(key);
    if (!action) return;
    using Action = RunKey::Action;
    show::Input input{.at = showClock_.showTime(moment), .source = source, .late = lateness_.isLate(moment)};
    switch (*action) {
        case Action::Go:
        case Action::Back:
            input.list = list_;
            [[fallthrough]];
        case Action::Blackout:
        case Action::Pause:
        case Action::Freeze:
        case Action::Panic:
        case Action::Restore:
            input.kind = kindOf(*action);
            return takeOver(input);
        case Action::Corrections:
        case Action::Lock:
        case Action::Release:
            input.kind = kindOf(*action);
            inputs_.submit(input);
            return;
        case Action::LoadPrevious:
        case Action::LoadNext:
            return load(input, *action == Action::LoadNext ? 1 : -1);
        case Action::NextList:
            return chooseList(input.at);
        case Action::Dimmer:
        case Action::Brighter:
            return dim(input, *action == Action::Brighter ? 1 : -1);
        case Action::Highlight:
        case Action::Solo:
        case Action::LampDimmer:
        case Action::LampBrighter:
        case Action::Park:
        case Action::Raise:
            return light(input, *action);
        case Action::NextRelay:
            return chooseRelay(input.at);
        case Action::SwitchRelay:
            return switchRelay(input);
        case Action::Pictures:
            return actions_.takePictures();
        case Action::Keys:
            return tellAll(input.at);
        case Action::Quit:
            if (quitKey_.press(moment)) return actions_.end();
            events_.append({input.at, show::event::QuitAsked{std::string(keyFor(*action)), QuitKey::kPatience}});
            return;
        case Action::SetUp:
            return;  // setUp has taken this key
    }
}

// Loads the cue `step` cues after the one that GO would enter.
void OperatorKeys::load(show::Input input, int step) {
    replica_.stateAt(input.at, state_);
    const show::CueList& main = replica_.playback().cues();
    const auto side = static_cast<std::size_t>(list_) - 1;
    const int last = static_cast<int>((list_ == 0 ? main : *main.sides[side]).cues.size()) - 1;
    const auto& next = list_ == 0 ? state_.next : state_.sides[side].next;
    input.kind = Kind::Load;
    input.list = list_;
    input.cue = std::clamp(next.value_or(last + 1) + step, 0, last);
    inputs_.submit(input);
}

// The keys, how it is, and what the schedule brings.
void OperatorKeys::tellAll(Time at) {
    events_.append({at, show::event::KeysAsked{runKeysText()}});
    replica_.stateAt(at, state_);
    events_.append({at, show::event::StateTold{actions_.howItIs(state_)}});
    if (std::string lines = actions_.nextDay(); !lines.empty()) events_.append({at, show::event::NextDayTold{std::move(lines)}});
}

void OperatorKeys::chooseList(Time at) {
    const auto& sides = replica_.playback().cues().sides;
    if (sides.empty()) return;
    list_ = (list_ + 1) % (static_cast<int>(sides.size()) + 1);
    events_.append({at, show::event::ListChosen{list_ == 0 ? "" : sides[static_cast<std::size_t>(list_) - 1]->name}});
}

// What a key does to single lamps.
void OperatorKeys::light(show::Input input, RunKey::Action action) {
    using Action = RunKey::Action;
    replica_.stateAt(input.at, state_);
    const int count = static_cast<int>(replica_.playback().cues().fixtures.size());
    input.kind = action == Action::Highlight ? Kind::Highlight
                 : action == Action::Solo    ? Kind::Solo
                 : action == Action::Park    ? Kind::Park
                 : action == Action::Raise   ? Kind::Raise
                                             : Kind::Level;
    input.fixture = state_.highlight;
    if (action == Action::Highlight) input.fixture = state_.highlight + 1 < count ? state_.highlight + 1 : -1;
    if (input.kind == Kind::Raise) input.level = state_.highlightLevel;
    if (input.kind == Kind::Level) input.level = stepped(state_.highlightLevel, action == Action::LampBrighter ? 1 : -1);
    inputs_.submit(input);
}

void OperatorKeys::chooseRelay(Time at) {
    const std::vector<std::string>& relays = actions_.relays;
    if (!relays.empty()) relay_ = (relay_ + 1) % static_cast<int>(relays.size());
    const std::string name = relays.empty() ? "" : relays[static_cast<std::size_t>(relay_)];
    events_.append({at, show::event::RelayChosen{name, std::string(keyFor(RunKey::Action::SwitchRelay))}});
}

// Switches the chosen relay the other way than it is.
void OperatorKeys::switchRelay(show::Input input) {
    if (relay_ < 0) return chooseRelay(input.at);
    replica_.stateAt(input.at, state_);
    input.kind = Kind::Switch;
    input.relay = relay_;
    input.on = state_.relays[static_cast<std::size_t>(relay_)] == 0;
    inputs_.submit(input);
}

void OperatorKeys::dim(show::Input input, int step) {
    replica_.stateAt(input.at, state_);
    input.kind = Kind::Master;
    input.level = stepped(state_.master, step);
    inputs_.submit(input);
}

void OperatorKeys::takeOver(const show::Input& input) {
    endSchedule(input.at);
    inputs_.submit(input);
}

void OperatorKeys::endSchedule(Time at) {
    if (!schedule_.ended()) events_.append({at, show::event::ScheduleEnded{}});
    schedule_.end();
}

}  // namespace fantascope::app
