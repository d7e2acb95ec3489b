#pragma once

#include "show/site/site_editor.h"

#include "device/screen_event.h"

#include "core/clock.h"

#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// The editor's command for a key; nothing if the key has no meaning there. The keys that add and
// remove points change the chosen mask if `tool` is Masks. With any other tool they change the
// chosen output's mesh, which has `mesh` points now.
std::optional<show::EditCommand> editCommandFor(const Key& key, show::edit::Tool tool, glm::ivec2 mesh);

// The legend of the keys, which is shown on the picture.
std::vector<std::string> editKeyLegend();

// Joins the characters that a terminal sends for one key. Thread: thread-bound.
class TerminalKeyParser {
public:
    // Takes the terminal's next character. Returns the key that it completes.
    std::optional<Key> take(char character);
    // Call this while the terminal sends nothing. An escape character that nothing follows for a
    // while was the Escape key. The wait is needed because a slow line may delay the rest of a
    // sequence.
    std::optional<Key> pause(Time moment);

private:
    std::string sequence_;
    std::optional<Time> pausedSince_;
};

}  // namespace fantascope::app
