#pragma once
// The messages of an Enttec DMX USB Pro and compatible widgets ("DMX USB PRO Widget API
// Specification", 1.44):
//     0x7e, label, length (low byte, high byte), data, 0xe7

#include "device/dmx_port.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fantascope::drivers {

enum class WidgetLabel : std::uint8_t {
    Parameters = 3,     // request and reply
    SetParameters = 4,  // stored by the widget, even without power
    Received = 5,       // a whole frame was received
    Send = 6,           // send this frame repeatedly
    ReceiveMode = 8,    // 0: every frame, 1: changes only
    Changed = 9,        // received slots that changed
    Number = 10,        // the widget's own serial number; request and reply
    Manufacturer = 77,  // request and reply; newer widgets only
    Device = 78         // the same
};

// The most data bytes of a message.
inline constexpr std::size_t kMaxWidgetData = 600;
// Longer than any message: this many bytes complete a message that was broken off.
inline constexpr std::size_t kMaxWidgetMessage = kMaxWidgetData + 5;

// The widget's parameters for sending, in its own units.
struct WidgetParameters {
    static constexpr double kTimeUnit = 10.67;  // microseconds

    int firmware = 0;                       // 256 * major + minor
    int breakTime = 0, markAfterBreak = 0;  // in kTimeUnit: 9 .. 127 and 1 .. 127
    int rate = 0;                           // frames a second, 1 .. 40; 0: as fast as it can
    friend bool operator==(const WidgetParameters&, const WidgetParameters&) = default;
};

struct WidgetMessage {
    WidgetLabel label{};
    std::vector<std::uint8_t> data;
};

// The start code, then the slots.
using DmxPacket = std::array<std::uint8_t, 1 + kDmxSlots>;
// A packet of levels (start code 0).
DmxPacket packetOf(std::span<const std::uint8_t, kDmxSlots> slots);

// At most kWidgetCapacity bytes of data.
std::vector<std::uint8_t> encoded(WidgetLabel label, std::span<const std::uint8_t> data);

// Finds messages in a stream of bytes. Other bytes are skipped; a message is found even inside
// bytes that only looked like one.
class WidgetParser {
public:
    void put(std::span<const std::uint8_t> bytes);
    // The next complete message.
    std::optional<WidgetMessage> next();

private:
    std::vector<std::uint8_t> waiting_;
};

// The parameters in a reply's data; nothing if the data are too short.
std::optional<WidgetParameters> parametersIn(std::span<const std::uint8_t> data);
std::vector<std::uint8_t> parametersRequest();
std::vector<std::uint8_t> dataOf(const WidgetParameters& wanted);
// The eight digits printed on the widget; "" if it has none.
std::optional<std::string> numberIn(std::span<const std::uint8_t> data);
// The name after the two bytes of an identity.
std::string nameIn(std::span<const std::uint8_t> data);

// Applies a Received or Changed message to `packet`. Returns whether it is a frame of levels (start
// code 0) that the widget received without error. Slots that a frame lacks are 0.
bool applyTo(const WidgetMessage& message, DmxPacket& packet);

}  // namespace fantascope::drivers
