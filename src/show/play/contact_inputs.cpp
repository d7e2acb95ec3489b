#include "show/play/contact_inputs.h"

#include "show/names.h"

#include <algorithm>

namespace fantascope::show {

std::optional<Input> inputFor(const Site& site, std::size_t bank, std::size_t contact, bool closed, bool witnessed, Time at,
                              const std::vector<std::string>& sides) {
    const auto declared = std::find_if(site.contacts.begin(), site.contacts.end(), [&](const Contact& candidate) {
        return candidate.bank == bank && static_cast<std::size_t>(candidate.input) == contact;
    });
    if (declared == site.contacts.end()) return std::nullopt;
    const auto action = closed ? declared->closes : declared->opens;
    if (!action) return std::nullopt;
    // In the order of ContactAction.
    constexpr struct {
        Input::Kind kind;
        bool isState;
    } kAsked[] = {{Input::Kind::Go, false},     {Input::Kind::Back, false}, {Input::Kind::Blackout, false},
                  {Input::Kind::Dark, true},    {Input::Kind::Light, true}, {Input::Kind::Pause, false},
                  {Input::Kind::Freeze, false}, {Input::Kind::Panic, true}, {Input::Kind::Restore, false}};
    const auto& asked = kAsked[static_cast<std::size_t>(*action)];
    if (!witnessed && !asked.isState) return std::nullopt;
    const auto which = static_cast<int>(declared - site.contacts.begin());
    const bool isOfList = asked.kind == Input::Kind::Go || asked.kind == Input::Kind::Back;
    const int list = isOfList ? listNamed(declared->list, sides) : 0;
    return Input{.at = at, .kind = asked.kind, .source = Input::Source::Contact, .which = which, .list = list};
}

}  // namespace fantascope::show
