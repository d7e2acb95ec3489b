#pragma once

#include "device/screen_event.h"

#include "core/clock.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace fantascope::app {

constexpr Key letterKey(char letter) { return {Key::Name::Letter, letter}; }

// A key, at the terminal or at a display's window, and its action while a show runs.
struct RunKey {
    enum class Action {
        Go,
        Back,
        LoadPrevious,
        LoadNext,
        NextList,
        Blackout,
        Pause,
        Freeze,
        Panic,
        Restore,
        Dimmer,
        Brighter,
        Highlight,
        Solo,
        LampDimmer,
        LampBrighter,
        Park,
        Raise,
        NextRelay,
        SwitchRelay,
        Release,
        Pictures,
        SetUp,
        Corrections,
        Lock,
        Keys,
        Quit
    };
    Key key;
    std::string_view name;  // on the keyboard
    std::string_view does;
    Action action;
};

// All keys. README.md has the same table.
constexpr std::array<RunKey, 27> kRunKeys = {
    {{letterKey(' '), "space", "GO: the loaded cue, or the next one; after a pause: go on", RunKey::Action::Go},
     {letterKey('b'), "b", "back: the cue before", RunKey::Action::Back},
     {{Key::Name::Up}, "up", "load the cue before the one that GO would enter", RunKey::Action::LoadPrevious},
     {{Key::Name::Down}, "down", "load the cue after the one that GO would enter", RunKey::Action::LoadNext},
     {{Key::Name::Tab}, "Tab", "GO, back, up and down go to the next cue list", RunKey::Action::NextList},
     {letterKey('0'), "0", "blackout; again: light", RunKey::Action::Blackout},
     {letterKey('p'), "p", "pause: the cues stand still; again: go on", RunKey::Action::Pause},
     {letterKey('f'), "f", "freeze what is seen; again: show the cues", RunKey::Action::Freeze},
     {{Key::Name::Escape}, "Esc", "panic: dark, relays safe, cues still; again: at once", RunKey::Action::Panic},
     {letterKey('r'), "r", "restore after a panic: everything goes on from where it was", RunKey::Action::Restore},
     {letterKey('-'), "-", "master: 10 % darker", RunKey::Action::Dimmer},
     {letterKey('+'), "+", "master: 10 % brighter", RunKey::Action::Brighter},
     {letterKey('h'), "h", "highlight: the next lamp at full, after the last one none", RunKey::Action::Highlight},
     {letterKey('o'), "o", "solo: nothing but that lamp; again: all", RunKey::Action::Solo},
     {letterKey(','), ",", "the highlighted lamp: 10 % darker", RunKey::Action::LampDimmer},
     {letterKey('.'), ".", "the highlighted lamp: 10 % brighter", RunKey::Action::LampBrighter},
     {letterKey('k'), "k", "park: keep that lamp as it is, whatever the cues do; again: let it go", RunKey::Action::Park},
     {letterKey('a'), "a", "by hand: the highlighted lamp shines at least as bright as now; at 0 %: as the cues have it", RunKey::Action::Raise},
     {letterKey('w'), "w", "choose the next relay", RunKey::Action::NextRelay},
     {letterKey('x'), "x", "switch that relay by hand; the next cue that names it switches it again", RunKey::Action::SwitchRelay},
     {letterKey('z'), "z", "release: the cues have all lamps and relays again", RunKey::Action::Release},
     {letterKey('s'), "s", "take a picture of every output", RunKey::Action::Pictures},
     {letterKey('e'), "e", "set the outputs up; again: done", RunKey::Action::SetUp},
     {letterKey('c'), "c", "take the camera's corrections back; again: allow them", RunKey::Action::Corrections},
     {letterKey('l'), "l", "lock hand controller, contacts and windows, but for darkness; again: unlock", RunKey::Action::Lock},
     {letterKey('?'), "?", "tell the keys, what is dark and why, and what comes", RunKey::Action::Keys},
     {letterKey('q'), "q", "end; `run` asks for it twice", RunKey::Action::Quit}}};

// Shift and Control do not matter.
std::optional<RunKey::Action> actionOf(const Key& key);
std::string_view keyFor(RunKey::Action action);

// A line for each key.
std::string runKeysText();
// The text for --help.
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
