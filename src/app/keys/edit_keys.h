#pragma once

#include "show/site/site_editor.h"

#include "device/screen_event.h"

#include "core/clock.h"

#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// What a key asks of the editor; nothing if it has no meaning there. The keys that make points more
// or fewer mean those of the masks where these are the tool, elsewhere those of the chosen output's
// mesh, which are `mesh` now.
std::optional<show::EditCommand> editCommandFor(const Key& key, show::edit::Tool tool, glm::ivec2 mesh);

// The keys in words, for people who stand before the picture.
std::vector<std::string> editKeyLegend();

// Puts together what a terminal sends for one key. Thread: thread-bound.
class TerminalKeyParser {
public:
    // The next of the terminal's characters. Gives the key that ends with it.
    std::optional<Key> take(char character);
    // The terminal has no more for now. An escape that nothing has followed for a while was the key
    // of that name; over a slow line the rest of a sequence comes later than its beginning.
    std::optional<Key> pause(Time moment);

private:
    std::string sequence_;
    std::optional<Time> pausedSince_;
};

}  // namespace fantascope::app
