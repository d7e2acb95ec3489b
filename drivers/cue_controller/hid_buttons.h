#pragma once
// From the reports of a HID device to buttons with numbers.

#include "drivers/cue_controller/hid_descriptor.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::drivers {

// A part of a device that somebody presses, turns or pushes, and the buttons that it stands for.
struct HidControl {
    enum class Kind {
        Key,      // one button: down above the middle of its range
        Keys,     // an array: one button for each of its usages
        Hat,      // four buttons: up, right, down, left; two of them between
        Wheel,    // two buttons: on and back, pressed and released once a detent
        Counter,  // the same of a position that wraps
        Axis,     // two buttons: pushed to its high end, to its low end
        Touch     // one button: pressed and released once a report whose value is within its range
    };
    Kind kind = Kind::Key;
    int interface = 0;
    std::size_t reportBytes = 0;  // a shorter report is no report
    HidField field;
    int first = 1;     // the number of its first button
    std::string name;  // what a profile calls it; empty: as its usage is called
    // The bytes by which a report is known that says something of it, where others share its id.
    struct Mark {
        std::size_t at = 0;
        std::uint8_t low = 0, high = 0;
    };
    std::vector<Mark> marks{};

    int buttons() const;
};

// An interface of a device and its report descriptor.
struct HidInterface {
    int number = 0;
    HidDescriptor descriptor;
};

// Every control of a device that can be taken for buttons, numbered from 1 in this order: keys (of
// any usage page) by interface and by place in the descriptor, an array's in the order of its
// usages; then hats; then wheels; then axes. What says that nothing is pressed (keyboard usages 0
// to 3, usage 0 elsewhere) has no number, nor has the movement of a pointer.
std::vector<HidControl> controlsOf(const std::vector<HidInterface>& interfaces);

// The number of the first button with this usage; 0: there is none.
int buttonOf(const std::vector<HidControl>& controls, HidUsage usage);

// A device's controls as it numbers them. `leading` are the numbers (by controlsOf) of the buttons
// that a profile puts first, so that they are 1, 2, ... on every device of its kind, 0 where this
// one has none; the others come after them in their order.
struct HidLayout {
    std::vector<HidControl> controls;
    std::vector<int> leading;

    int count() const;  // of buttons
    int numberOf(int button) const;
};

struct NamedButton {
    int number = 0;
    std::string name;  // "button 3", "Page Down", "hat up", "jog on"
    friend bool operator==(const NamedButton&, const NamedButton&) = default;
};

// All buttons of a device, by number.
std::vector<NamedButton> buttonsOf(const HidLayout& layout);

struct ButtonChange {
    enum class What { Up, Down, Detent };
    int button = 0;
    What what = What::Up;
    friend bool operator==(const ButtonChange&, const ButtonChange&) = default;
};

// The buttons of one device, as its reports say.
class HidButtons {
public:
    explicit HidButtons(HidLayout layout) : layout_(std::move(layout)), positions_(layout_.controls.size()) {}

    // What the report changes: what went up, then what went down, then detents. Nothing for a
    // report that is too short, has an unknown id, or says what was known. A position that wraps is
    // known from its first report on.
    std::vector<ButtonChange> take(int interface, std::span<const std::uint8_t> report);

private:
    const HidLayout layout_;
    std::vector<std::optional<std::int64_t>> positions_;  // of counters
    std::set<int> down_;                                  // by controlsOf's numbers
};

}  // namespace fantascope::drivers
