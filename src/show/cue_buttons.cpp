#include "show/cue_buttons.h"

#include <algorithm>

namespace fantascope::show {

namespace {

Input::Kind kindOf(Button button) {
    switch (button) {
        case Button::Go:
            return Input::Kind::Go;
        case Button::Back:
            return Input::Kind::Back;
        case Button::Blackout:
            break;
    }
    return Input::Kind::Blackout;
}

}  // namespace

CueButtons::CueButtons(const std::vector<std::pair<int, Button>>& buttons) {
    for (const auto& [number, button] : buttons) keys_.push_back({number, button});
}

std::optional<Input> CueButtons::inputFor(int button, bool pressed, Time at) {
    const auto key = std::find_if(keys_.begin(), keys_.end(), [&](const Key& candidate) { return candidate.number == button; });
    if (key == keys_.end()) return std::nullopt;
    const bool wasDown = std::exchange(key->down, pressed);
    if (!pressed || wasDown) return std::nullopt;
    return Input{.at = at, .kind = kindOf(key->button)};
}

}  // namespace fantascope::show
