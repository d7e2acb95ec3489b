#pragma once
// How a HID device is told what its buttons are to show.

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
    int id = 0;                       // 0: its interface has one report, without an id
    std::vector<std::uint8_t> bytes;  // its id first, if it has one
};

// The two backlights of an X-keys key, or the one of a stick.
struct XkeysLamps {
    std::vector<int> blue;  // the index of each button's, from button 1 on
    int red = 0;            // from the blue one's index to the red one's; 0: there is none
};

// The small displays of Stream Decks' keys.
struct StreamDeckLamps {
    enum class Protocol {
        Original,  // the first one: two large reports a picture, keys counted from the right
        Mini,
        Main  // all since the second version
    };
    Protocol protocol = Protocol::Main;
    int keys = 0, columns = 0;
    KeyPictureFormat picture;
    int colours = 0;  // touch keys after the keys, which have a colour only
};

// The outputs of the LED page (08) that the descriptors name, in their order: the lamps of buttons
// 1, 2, ...
struct LedPageLamps {};

// Nothing: it has no lamps, or none that are known.
using HidLampKind = std::variant<std::monostate, XkeysLamps, StreamDeckLamps, LedPageLamps>;

// The lamps of one device, as they were told.
class HidLamps {
public:
    virtual ~HidLamps() = default;
    // They are of the buttons from 1 to this.
    virtual int count() const = 0;
    // Before the first: how bright they are, 0..1.
    virtual std::vector<HidOutReport> begin(double brightness) const = 0;
    // None: the button has no lamp.
    virtual std::vector<HidOutReport> show(int button, const ButtonLight& light) = 0;
};

// Null: it has none.
std::unique_ptr<HidLamps> lampsOf(const HidLampKind& kind, const std::vector<HidInterface>& interfaces);

}  // namespace fantascope::drivers
