#pragma once
// Turns the reports of a HID device into numbered buttons.

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

// A physical control of a device, and the buttons that it stands for.
struct HidControl {
    enum class Kind {
        Key,      // one button: down above the middle of its range
        Keys,     // an array: one button per usage
        Hat,      // four buttons: up, right, down, left; between two of them, both
        Wheel,    // two buttons, on and back: a press and a release per detent
        Counter,  // the same for a position that wraps
        Axis,     // two buttons: its high end, its low end
        Touch     // one button: a press and a release per report whose value is in its range
    };
    Kind kind = Kind::Key;
    int interface = 0;
    std::size_t reportBytes = 0;  // shorter reports are ignored
    HidField field;
    int first = 1;     // the number of its first button
    std::string name;  // from a profile; empty: named after its usage
    // Bytes that identify the reports for this control if several kinds share its id.
    struct Mark {
        std::size_t at = 0;
        std::uint8_t low = 0, high = 0;
    };
    std::vector<Mark> marks{};

    int buttons() const;
};

// A HID interface of a device.
struct HidInterface {
    int number = 0;
    HidDescriptor descriptor;
};

// Every control of a device that can serve as buttons. They are numbered from 1 in this order: keys
// (of any usage page) by interface and by place in the descriptor, an array's keys in the order of
// its usages; then hats; then wheels; then axes. Usages for "nothing pressed" (keyboard usages 0 to
// 3, usage 0 elsewhere) and the movement of a pointer have no number.
std::vector<HidControl> controlsOf(const std::vector<HidInterface>& interfaces);

// The number of the first button with this usage; 0: none.
int buttonOf(const std::vector<HidControl>& controls, HidUsage usage);

// A device's controls and the numbers of their buttons. `firstKeys` are the buttons (by their
// numbers from controlsOf) that a profile puts first, so that they are 1, 2, ... on every device of
// its kind; 0 if this device lacks one. The others follow in their order.
struct HidLayout {
    std::vector<HidControl> controls;
    std::vector<int> firstKeys;

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

// Tracks the buttons of one device from its reports.
class HidButtons {
public:
    explicit HidButtons(HidLayout layout) : layout_(std::move(layout)), positions_(layout_.controls.size()) {}

    // The changes by a report: first releases, then presses, then detents. Nothing for a report
    // that is too short, has an unknown id, or changes nothing. The first report of a wrapping
    // position only sets it.
    std::vector<ButtonChange> take(int interface, std::span<const std::uint8_t> report);

private:
    const HidLayout layout_;
    std::vector<std::optional<std::int64_t>> positions_;  // of counters
    std::set<int> down_;                                  // numbers from controlsOf
};

}  // namespace fantascope::drivers
