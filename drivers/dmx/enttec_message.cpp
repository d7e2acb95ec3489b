#include "drivers/dmx/enttec_message.h"

#include "core/check.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::drivers {
namespace {

constexpr std::uint8_t kStart = 0x7e, kEnd = 0xe7;
constexpr std::size_t kHeader = 4;

}  // namespace

std::vector<std::uint8_t> encoded(WidgetLabel label, std::span<const std::uint8_t> data) {
    FANTASCOPE_CHECK(data.size() <= kMaxWidgetData, "a message holds at most kMaxWidgetData bytes");
    std::vector<std::uint8_t> message{kStart, static_cast<std::uint8_t>(label), static_cast<std::uint8_t>(data.size() & 0xff),
                                      static_cast<std::uint8_t>(data.size() >> 8)};
    message.insert(message.end(), data.begin(), data.end());
    message.push_back(kEnd);
    return message;
}

void WidgetParser::put(std::span<const std::uint8_t> bytes) { waiting_.insert(waiting_.end(), bytes.begin(), bytes.end()); }

std::optional<WidgetMessage> WidgetParser::next() {
    auto start = waiting_.begin();
    std::optional<WidgetMessage> found;
    while (!found) {
        start = std::find(start, waiting_.end(), kStart);
        const auto size = static_cast<std::size_t>(waiting_.end() - start);
        if (size < kHeader) break;
        const std::size_t length = start[2] + 256u * start[3];
        const auto data = start + kHeader;
        if (length > kMaxWidgetData) {
            ++start;
        } else if (size <= kHeader + length) {
            break;  // incomplete so far
        } else if (const auto end = data + static_cast<std::ptrdiff_t>(length); *end != kEnd) {
            ++start;
        } else {
            found = WidgetMessage{static_cast<WidgetLabel>(start[1]), {data, end}};
            start = end + 1;
        }
    }
    waiting_.erase(waiting_.begin(), start);
    return found;
}

std::optional<WidgetParameters> parametersIn(std::span<const std::uint8_t> data) {
    if (data.size() < 5) return std::nullopt;
    return WidgetParameters{data[0] + 256 * data[1], data[2], data[3], data[4]};
}

std::vector<std::uint8_t> parametersRequest() { return {0, 0}; }  // no user configuration

std::vector<std::uint8_t> dataOf(const WidgetParameters& wanted) {
    return {0, 0, static_cast<std::uint8_t>(wanted.breakTime), static_cast<std::uint8_t>(wanted.markAfterBreak),
            static_cast<std::uint8_t>(wanted.rate)};
}

std::optional<std::string> numberIn(std::span<const std::uint8_t> data) {
    if (data.size() < 4) return std::nullopt;
    const std::string digits =
        fmt::format("{:02x}{:02x}{:02x}{:02x}", data[3], data[2], data[1], data[0]);  // four bits per digit
    return digits == "ffffffff" ? "" : digits;
}

std::string nameIn(std::span<const std::uint8_t> data) {
    if (data.size() < 2) return "";
    return {data.begin() + 2, std::find(data.begin() + 2, data.end(), 0)};
}

DmxPacket packetOf(std::span<const std::uint8_t, kDmxSlots> slots) {
    DmxPacket packet{};
    std::copy(slots.begin(), slots.end(), packet.begin() + 1);
    return packet;
}

bool applyTo(const WidgetMessage& message, DmxPacket& packet) {
    const std::vector<std::uint8_t>& data = message.data;
    if (message.label == WidgetLabel::Received) {
        const bool well = data.size() >= 2 && data.size() <= 1 + packet.size() && data[0] == 0;
        if (!well || data[1] != 0) return false;
        packet.fill(0);
        std::copy(data.begin() + 1, data.end(), packet.begin());
        return true;
    }
    // One bit per slot tells which of 40 slots have changed, counted from eight times the first
    // byte. Their values follow.
    constexpr std::size_t kBits = 40, kBitBytes = kBits / 8;
    if (message.label != WidgetLabel::Changed || data.size() < 1 + kBitBytes) return false;
    std::size_t value = 1 + kBitBytes;
    for (std::size_t bit = 0; bit < kBits; ++bit) {
        if ((data[1 + bit / 8] >> (bit % 8) & 1) == 0) continue;
        const std::size_t slot = 8u * data[0] + bit;
        if (slot >= packet.size() || value >= data.size()) return false;
        packet[slot] = data[value++];
    }
    return packet[0] == 0;
}

}  // namespace fantascope::drivers
