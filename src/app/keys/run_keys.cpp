#include "app/keys/run_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fantascope::app {

std::optional<RunKey::Action> actionOf(const Key& key) {
    // Two characters of one key on many keyboards count as one.
    const char letter = key.letter == '=' ? '+' : key.letter == '/' ? '?' : key.letter;
    const auto found =
        std::ranges::find_if(kRunKeys, [&](const RunKey& run) { return run.key.name == key.name && run.key.letter == letter; });
    return found == kRunKeys.end() ? std::nullopt : std::optional(found->action);
}

std::string_view keyFor(RunKey::Action action) { return std::ranges::find(kRunKeys, action, &RunKey::action)->name; }

std::string runKeysText() {
    std::string text;
    for (const RunKey& key : kRunKeys) text += fmt::format("  {:<7}{}\n", key.name, key.does);
    return text;
}

std::string runKeysHelp() {
    return "Keys while the show runs:\n" + runKeysText() +
           "  Ctrl-C end at once\n  Ctrl-Z nothing: it would leave the relays as they are\n";
}

bool QuitKey::press(Time moment) {
    const std::optional<Time> before = std::exchange(pressed_, moment);
    return !asks_ || (before && moment - *before <= kPatience);
}

}  // namespace fantascope::app
