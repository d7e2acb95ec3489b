#pragma once

#include "drivers/display/monitor.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::drivers {

// An output's claim on a monitor of the X screen.
struct MonitorClaim {
    std::string name;  // of the output
    MonitorChoice monitor;
    glm::ivec2 size{0};                  // of the mode, pixels
    double refreshRate = 0;              // Hz; among the modes of that size the nearest rate is used
    std::optional<glm::ivec2> position;  // of its top left corner; nothing: any free place
};

// Decides where each output's picture goes: finds the claimed monitors by identity and plans what
// to switch.
//
// A monitor that is on in the right mode stays where it is, unless two outputs would overlap. Any
// other goes to its `position`, to its last place, or to the right of everything else. The place of
// an absent output is kept free, so that nothing has to move, and the screen does not have to grow,
// when it comes. A monitor is switched on when it appears. If somebody switches it off while it
// shows a picture, it stays off until somebody switches it on or replugs it.
// It does not talk to the X server: it gets the monitors and returns what to do. Thread:
// thread-bound.
class Placement {
public:
    // A claim's state at the last look().
    struct Seat {
        std::string absence;  // why it shows nothing and what to do about it; empty: its monitor shows `area`
        Area area;            // of the X screen
        double hertz = 0;     // of its monitor; 0: unknown
        bool operator==(const Seat&) const = default;
    };
    // Switches a monitor on, or to another mode or place.
    struct Change {
        int claim = 0;  // the claim that it serves
        std::uint32_t outputId = 0, crtcId = 0, modeId = 0;
        glm::ivec2 corner{0};
        bool operator==(const Change&) const = default;
    };
    struct Plan {
        glm::ivec2 screen{0};         // the minimum size of the X screen, to be set before the changes
        std::vector<Change> changes;  // a change is not repeated before it has worked, or retry()
    };

    // Returns a number for the claim. Earlier claims choose first.
    int add(MonitorClaim claim);
    void remove(int claim);
    // What to do with these monitors, if the X screen can be at most `largest` pixels.
    Plan look(const std::vector<Monitor>& monitors, glm::ivec2 largest);
    // Reports that a change from look() failed.
    void refused(int claim, const std::string& why);
    // Lets the next look() repeat changes that failed.
    void retry();
    // The X server ended, and a new one has switched monitors on by its own rules. The places stay.
    void restart();
    // By claim number.
    std::map<int, Seat> seats() const;

private:
    enum class Life { Away, Wanted, Shown, SwitchedOff };
    struct Holder {
        int number;
        MonitorClaim claim;
        Life life = Life::Away;
        std::string connector{};               // of its monitor, unless it is away
        std::optional<glm::ivec2> reserved{};  // the corner of its reserved place
        std::optional<Change> tried{};         // requested, not yet seen to work
        std::string failure{};                 // ... and why it failed
        Seat seat{};
        const Monitor* monitor = nullptr;     // in this look()
        const Monitor::Mode* mode = nullptr;  // ... and the mode that it should show
    };
    struct Round;
    void find(Holder& holder, const std::vector<Monitor>& monitors);
    bool keeps(Holder& holder, Round& round);
    void place(Holder& holder, Round& round);
    void reserve(Holder& holder, Round& round);

    std::vector<Holder> holders_;  // in the order of their numbers
    int next_ = 0;
};

}  // namespace fantascope::drivers
