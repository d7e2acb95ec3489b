#pragma once

#include "drivers/display/monitor.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::drivers {

// What an output wants of the X screen.
struct MonitorClaim {
    std::string name;  // the output's
    MonitorChoice monitor;
    glm::ivec2 size{0};                  // of the mode, pixels
    double refreshRate = 0;              // Hz: of the modes of that size the nearest one
    std::optional<glm::ivec2> position;  // of its top left corner; nothing: wherever there is room
};

// Where each output's picture is to be: it finds the monitors that the outputs claim, by identity,
// and decides what has to be switched.
//
// What is on in the right mode stays where it is, unless two outputs would overlap. Anything else
// comes to its `position`, to the place that it had before, or right of everything else. The place
// of an output that is absent is kept free, so that nothing has to move, and the screen does not
// have to grow, when it comes. A monitor is switched on when it arrives; one that somebody switches
// off while it shows a picture stays off until somebody switches it on, or plugs it in again.
// It knows no X server: it is told what there is, and tells what to do. Thread: thread-bound.
class Placement {
public:
    // Of a claim at the last look.
    struct Seat {
        std::string absence;  // why it shows nothing and what to do about it; empty: its monitor shows `area`
        Area area;            // of the X screen
        double hertz = 0;     // of its monitor; 0: unknown
        bool operator==(const Seat&) const = default;
    };
    // Switches a monitor on, or over.
    struct Change {
        int claim = 0;  // whom it is for
        std::uint32_t outputId = 0, crtcId = 0, modeId = 0;
        glm::ivec2 corner{0};
        bool operator==(const Change&) const = default;
    };
    struct Plan {
        glm::ivec2 screen{0};         // the least size of the X screen that holds everything, before the changes
        std::vector<Change> changes;  // none is asked for twice before it was seen to work, or retry()
    };

    // A number for the claim, to be used below. Earlier ones have the first choice.
    int add(MonitorClaim claim);
    void remove(int claim);
    // What has to be done now that the monitors are these, and the X screen can be `largest` pixels
    // at most.
    Plan look(const std::vector<Monitor>& monitors, glm::ivec2 largest);
    // A change that look() asked for did not succeed.
    void refused(int claim, const std::string& why);
    // Changes that did not succeed are asked for again by the next look().
    void retry();
    // The X server is gone, and a new one has switched on what it likes. The places stay.
    void restart();
    // By the claims' numbers.
    std::map<int, Seat> seats() const;

private:
    enum class Life { Away, Wanted, Shown, SwitchedOff };
    struct Holder {
        int number;
        MonitorClaim claim;
        Life life = Life::Away;
        std::string connector{};               // where its monitor is, unless it is away
        std::optional<glm::ivec2> reserved{};  // the corner of the place that is kept for it
        std::optional<Change> tried{};         // that was not seen to work yet
        std::string failure{};                 // ... and why not
        Seat seat{};
        const Monitor* monitor = nullptr;     // in this round
        const Monitor::Mode* mode = nullptr;  // ... what it is to show there
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
