#include "show/play/cue_buttons.h"

#include "show/names.h"

#include <algorithm>
#include <utility>

namespace fantascope::show {

namespace {

// The buttons that give an input; the others are for setting up.
constexpr std::pair<Button, Input::Kind> kInputButtons[] = {
    {Button::Go, Input::Kind::Go},          {Button::Back, Input::Kind::Back},     {Button::Blackout, Input::Kind::Blackout},
    {Button::Pause, Input::Kind::Pause},    {Button::Freeze, Input::Kind::Freeze}, {Button::Panic, Input::Kind::Panic},
    {Button::Restore, Input::Kind::Restore}};

}  // namespace

CueButtons::CueButtons(const std::vector<SiteButton>& buttons, const std::vector<std::string>& sides) {
    for (const auto& [number, button, list] : buttons)
        for (const auto& [known, kind] : kInputButtons)
            if (known == button) keys_.push_back({number, kind, listNamed(list, sides)});
}

std::optional<Input> CueButtons::inputFor(int button, bool pressed, Time at) {
    const auto key = std::find_if(keys_.begin(), keys_.end(), [&](const Key& candidate) { return candidate.number == button; });
    if (key == keys_.end()) return std::nullopt;
    const bool wasDown = std::exchange(key->down, pressed);
    if (!pressed || wasDown) return std::nullopt;
    return Input{.at = at, .kind = key->kind, .source = Input::Source::Controller, .which = button, .list = key->list};
}

}  // namespace fantascope::show
