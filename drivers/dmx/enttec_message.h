#pragma once
// What an Enttec DMX USB Pro and its kin say over their line ("DMX USB PRO Widget API
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
    Parameters = 3,     // asked and answered
    SetParameters = 4,  // kept by the widget when its plug is pulled
    Received = 5,       // a whole frame came in
    Send = 6,           // this frame is to go out, over and over
    ReceiveMode = 8,    // 0: every frame, 1: what has changed
    Changed = 9,        // some slots came in changed
    Number = 10,        // the widget's own serial number, asked and answered
    Manufacturer = 77,  // asked and answered, by newer widgets
    Device = 78         // the same
};

// The most data that a message can hold.
inline constexpr std::size_t kWidgetCapacity = 600;
// The length of no message: where one was broken off, so many bytes end it.
inline constexpr std::size_t kWidgetLongest = kWidgetCapacity + 5;

// Of what the widget sends, in its units.
struct WidgetParameters {
    static constexpr double kTimeUnit = 10.67;  // microseconds

    int firmware = 0;                       // 256 * major + minor
    int breakTime = 0, markAfterBreak = 0;  // in kTimeUnit: 9 .. 127 and 1 .. 127
    int rate = 0;                           // frames a second, 1 .. 40; 0 as fast as it can
    friend bool operator==(const WidgetParameters&, const WidgetParameters&) = default;
};

struct WidgetMessage {
    WidgetLabel label{};
    std::vector<std::uint8_t> data;
};

// The start code, then the slots.
using DmxPacket = std::array<std::uint8_t, 1 + kDmxSlots>;
// With the start code of levels.
DmxPacket packetOf(std::span<const std::uint8_t, kDmxSlots> slots);

// At most kWidgetCapacity bytes of data.
std::vector<std::uint8_t> encoded(WidgetLabel label, std::span<const std::uint8_t> data);

// Finds the messages in what arrives. What is none is skipped; a message inside of what only looked
// like one is found all the same.
class WidgetParser {
public:
    void put(std::span<const std::uint8_t> bytes);
    // The next message that is whole.
    std::optional<WidgetMessage> next();

private:
    std::vector<std::uint8_t> waiting_;
};

// What the data of an answer say; nothing where they are too few.
std::optional<WidgetParameters> parametersIn(std::span<const std::uint8_t> data);
std::vector<std::uint8_t> parametersRequest();
std::vector<std::uint8_t> dataOf(const WidgetParameters& wanted);
// The eight digits that stand on the widget; "" where it was given none.
std::optional<std::string> numberIn(std::span<const std::uint8_t> data);
// The name behind the two bytes of an identity.
std::string nameIn(std::span<const std::uint8_t> data);

// Takes over what came in, of a Received or a Changed message. Whether it is a frame of levels
// (start code 0) that the widget received well; slots that a frame did not have are 0.
bool takeOver(const WidgetMessage& message, DmxPacket& packet);

}  // namespace fantascope::drivers
