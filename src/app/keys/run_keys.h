#pragma once

#include "core/clock.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace fantascope::app {

// A key, at the terminal or at a display's window, and its action while a show runs.
struct RunKey {
    enum class Action { Go, Back, Blackout, Pictures, SetUp, Corrections, Lock, Quit };
    char letter;
    std::string_view name;  // on the keyboard
    std::string_view does;
    Action action;
};

// All keys. README.md has the same table.
constexpr std::array<RunKey, 8> kRunKeys = {
    {{' ', "space", "GO: the next cue", RunKey::Action::Go},
     {'b', "b", "back: the cue before", RunKey::Action::Back},
     {'0', "0", "blackout; again: light", RunKey::Action::Blackout},
     {'s', "s", "take a picture of every output", RunKey::Action::Pictures},
     {'e', "e", "set the outputs up; again: done", RunKey::Action::SetUp},
     {'c', "c", "take the camera's corrections back; again: allow them", RunKey::Action::Corrections},
     {'l', "l", "lock GO and back of hand controller, contacts and windows; again: unlock", RunKey::Action::Lock},
     {'q', "q", "end; `run` asks for it twice", RunKey::Action::Quit}}};

std::optional<RunKey::Action> actionOf(char letter);
std::string_view keyFor(RunKey::Action action);

// The text for --help: a line for each key.
std::string runKeysHelp();

// The key that ends a run. A rehearsal ends at once, because it is easy to begin again. A night
// with an audience ends only when the key is pressed twice, so that a slip of the finger does not
// end it.
// Thread: one at a time.
class QuitKey {
public:
    static constexpr Time kPatience = std::chrono::seconds(3);
    explicit QuitKey(bool asks) : asks_(asks) {}
    // Takes a press at `moment` on the machine's clock. Returns whether it ends the run.
    bool press(Time moment);

private:
    const bool asks_;
    std::optional<Time> pressed_;
};

}  // namespace fantascope::app
