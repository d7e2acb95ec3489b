#pragma once
// The packets of Art-Net 4 (Artistic Licence, Art-Net 4 Protocol Release) that carry levels and
// discover nodes, as bytes and as values. No sockets, no clocks.

#include "drivers/dmx/udp_socket.h"

#include "device/dmx_port.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace fantascope::drivers::artnet {

inline constexpr std::uint16_t kUdpPort = 6454;
inline constexpr int kLastPortAddress = 0x7fff;  // 15 bits: net (7), sub-net (4), universe (4)

struct Dmx {
    std::uint8_t sequence = 0;  // 1 .. 255; 0: not counted
    int portAddress = 0;
    std::array<std::uint8_t, kDmxSlots> slots{};  // missing slots are 0
};
struct Sync {};
struct Poll {};

// A node's or controller's description of itself. One with many ports sends several replies, told
// apart by bindIndex.
struct PollReply {
    Ipv4 address;
    std::array<std::uint8_t, 6> hardware{};
    std::string shortName, longName;  // at most 17 and 63 bytes
    bool controller = false;
    int bindIndex = 1;
    std::vector<int> outputs,
        inputs;  // port-addresses, at most four each. DMX leaves the node at an output and enters it at an input
};

using Packet = std::variant<Dmx, Sync, Poll, PollReply>;
// Nothing if it is not a complete packet of these kinds, or its protocol version is below 14.
std::optional<Packet> read(std::span<const std::uint8_t> bytes);

std::array<std::uint8_t, 530> bytesOf(const Dmx& dmx);
std::array<std::uint8_t, 14> bytesOf(Sync);
std::array<std::uint8_t, 14> bytesOf(Poll);  // requests a reply now and after each change
// All ports of a reply share net and sub-net.
std::array<std::uint8_t, 239> bytesOf(const PollReply& reply);

// As sacn::isLate, but the sequence number wraps from 255 to 1, and 0 is never late.
constexpr bool isLate(std::uint8_t sequence, std::uint8_t last) {
    if (sequence == 0 || last == 0) return false;
    int difference = sequence - last;
    if (difference > 127) difference -= 255;
    if (difference < -127) difference += 255;
    return difference <= 0 && difference > -20;
}

}  // namespace fantascope::drivers::artnet
