#include "app/keys/operator_keys.h"

#include <string>
#include <utility>

namespace fantascope::app {

using Source = show::Input::Source;
using Kind = show::Input::Kind;

OperatorKeys::OperatorKeys(show::InputLog& inputs, show::EventLog& events, const show::ShowClock& showClock,
                           std::unique_ptr<TerminalKeys> terminal, GoSchedule schedule, QuitKey quitKey, Actions actions)
    : inputs_(inputs),
      events_(events),
      showClock_(showClock),
      terminal_(std::move(terminal)),
      schedule_(schedule),
      quitKey_(quitKey),
      actions_(std::move(actions)) {}

void OperatorKeys::tick(Time moment) {
    while (const auto character = terminal_ ? terminal_->poll() : std::nullopt)
        if (const auto key = parser_.take(*character)) press(*key, Source::Terminal, moment);
    if (const auto key = parser_.pause(moment)) press(*key, Source::Terminal, moment);
    while (const Press* const pressed = pressedAtScreens_.next()) press(pressed->key, Source::Screen, pressed->moment);
    if (schedule_.due(showClock_.runTime(moment)) && !actions_.pressGo())
        inputs_.submit({.at = showClock_.showTime(moment), .kind = Kind::Go, .source = Source::Schedule});
    nextGo_ = schedule_.next();
}

// A key acts like a button of the hand controller. A key that gives an input ends the schedule.
void OperatorKeys::press(const Key& key, Source source, Time moment) {
    if (actions_.setUp(key)) return;
    const auto action = actionOf(key.letter);
    if (!action) return;
    const Time showTime = showClock_.showTime(moment);
    switch (*action) {
        case RunKey::Action::Go:
            return takeOver({.at = showTime, .kind = Kind::Go, .source = source});
        case RunKey::Action::Back:
            return takeOver({.at = showTime, .kind = Kind::Back, .source = source});
        case RunKey::Action::Blackout:
            return takeOver({.at = showTime, .kind = Kind::Blackout, .source = source});
        case RunKey::Action::Corrections:
            inputs_.submit({.at = showTime, .kind = Kind::Corrections, .source = source});
            return;
        case RunKey::Action::Lock:
            inputs_.submit({.at = showTime, .kind = Kind::Lock, .source = source});
            return;
        case RunKey::Action::Pictures:
            return actions_.takePictures();
        case RunKey::Action::Quit:
            if (quitKey_.press(moment)) return actions_.end();
            events_.append({showTime, show::event::QuitAsked{std::string(keyFor(*action)), QuitKey::kPatience}});
            return;
        case RunKey::Action::SetUp:
            return;  // setUp has taken this key
    }
}

void OperatorKeys::takeOver(const show::Input& input) {
    if (!schedule_.ended()) events_.append({input.at, show::event::ScheduleEnded{}});
    schedule_.end();
    inputs_.submit(input);
}

}  // namespace fantascope::app
