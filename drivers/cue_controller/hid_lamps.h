#pragma once
// The reports that light the lamps of HID devices.

#include "drivers/cue_controller/hid_buttons.h"
#include "drivers/cue_controller/key_picture.h"

#include "device/cue_controller.h"

#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

namespace fantascope::drivers {

// A report to a device.
struct HidOutReport {
    int interface = 0;
    bool feature = false;             // else an output report
    int id = 0;                       // 0: the only report of its interface, without an id
    std::vector<std::uint8_t> bytes;  // its id first, if it has one
};

// The two backlights of an X-keys key, or the single one of a stick.
struct XkeysLamps {
    std::vector<int> blue;  // each button's index, from button 1
    int red = 0;            // red index minus blue index; 0: no red
};

// The small displays in the keys of Stream Decks.
struct StreamDeckLamps {
    enum class Protocol {
        Original,  // the first version: two large reports per picture, keys counted from the right
        Mini,
        Main  // all from the second version on
    };
    Protocol protocol = Protocol::Main;
    int keys = 0, columns = 0;
    KeyPictureFormat picture;
    int colours = 0;  // touch keys after the keys; they show only a colour
};

// The outputs of the LED page (08) in the descriptors, in their order: the lamps of buttons 1, 2,
// ...
struct LedPageLamps {};

// std::monostate: no lamps, or none known.
using HidLampKind = std::variant<std::monostate, XkeysLamps, StreamDeckLamps, LedPageLamps>;

// Drives the lamps of one device.
class HidLamps {
public:
    virtual ~HidLamps() = default;
    // The last button with a lamp; the first is 1.
    virtual int count() const = 0;
    // Reports to send first; `brightness` is 0..1.
    virtual std::vector<HidOutReport> begin(double brightness) const = 0;
    // Empty if the button has no lamp.
    virtual std::vector<HidOutReport> show(int button, const ButtonLight& light) = 0;
};

// Null: no lamps.
std::unique_ptr<HidLamps> lampsOf(const HidLampKind& kind, const std::vector<HidInterface>& interfaces);

}  // namespace fantascope::drivers
