#include "show/play/cue_buttons.h"

#include <algorithm>

namespace fantascope::show {

namespace {

std::optional<Input::Kind> kindOf(Button button) {
    switch (button) {
        case Button::Go:
            return Input::Kind::Go;
        case Button::Back:
            return Input::Kind::Back;
        case Button::Blackout:
            return Input::Kind::Blackout;
        case Button::Pause:
            return Input::Kind::Pause;
        case Button::Freeze:
            return Input::Kind::Freeze;
        case Button::Panic:
            return Input::Kind::Panic;
        case Button::Restore:
            return Input::Kind::Restore;
        default:  // those for setting up
            return std::nullopt;
    }
}

}  // namespace

CueButtons::CueButtons(const std::vector<std::pair<int, Button>>& buttons) {
    for (const auto& [number, button] : buttons)
        if (const auto kind = kindOf(button)) keys_.push_back({number, *kind});
}

std::optional<Input> CueButtons::inputFor(int button, bool pressed, Time at) {
    const auto key = std::find_if(keys_.begin(), keys_.end(), [&](const Key& candidate) { return candidate.number == button; });
    if (key == keys_.end()) return std::nullopt;
    const bool wasDown = std::exchange(key->down, pressed);
    if (!pressed || wasDown) return std::nullopt;
    return Input{.at = at, .kind = key->kind, .source = Input::Source::Controller, .which = button};
}

}  // namespace fantascope::show
