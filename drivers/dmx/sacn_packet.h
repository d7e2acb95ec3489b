#pragma once
// The packets of ANSI E1.31-2018 ("sACN"), as bytes and as values. No sockets, no clocks.

#include "device/dmx_port.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace fantascope::drivers::sacn {

inline constexpr std::uint16_t kUdpPort = 5568;
inline constexpr int kLastUniverse = 63999, kDiscoveryUniverse = 64214;
inline constexpr std::size_t kNameSize = 64;  // of a source's name, with its final zero
inline constexpr std::size_t kUniversesOnPage = 512;

// The multicast group of a universe: 239.255.hi.lo (section 9.3.1).
constexpr std::uint32_t groupOf(int universe) { return 0xefff0000u | static_cast<std::uint32_t>(universe); }

using Cid = std::array<std::uint8_t, 16>;  // identifies the sending component
std::string textOf(const Cid& cid);        // as a UUID: "3f8a..."
// The CID for a name, the same on any machine: a UUID of version 8 (RFC 9562).
Cid cidFor(std::string_view name);

// Levels of one universe (section 6, table 4-1).
struct Data {
    Cid cid{};
    std::string name;  // of the source
    int universe = 1, priority = 100;
    int sync = 0;  // the universe whose sync packets release it; 0: none
    std::uint8_t sequence = 0;
    bool preview = false, terminated = false, force = false;  // force: receivers go on unsynchronised if sync packets stop
    std::uint8_t startCode = 0;
    std::array<std::uint8_t, kDmxSlots> slots{};  // missing slots are 0
};

struct Sync {
    Cid cid{};
    std::uint8_t sequence = 0;
    int universe = 0;
};

// The universes that a source sends, in pages (section 8).
struct Discovery {
    Cid cid{};
    std::string name;
    int page = 0, lastPage = 0;
    std::vector<int> universes;
};

using Packet = std::variant<Data, Sync, Discovery>;
// Nothing if it is not a complete packet of these kinds.
std::optional<Packet> read(std::span<const std::uint8_t> bytes);

using DataBytes = std::array<std::uint8_t, 638>;
using SyncBytes = std::array<std::uint8_t, 49>;
// Names are cut after kNameSize - 1 bytes.
DataBytes bytesOf(const Data& data);
SyncBytes bytesOf(const Sync& sync);
std::vector<std::uint8_t> bytesOf(const Discovery& discovery);  // universes.size() <= kUniversesOnPage

// Whether a packet is late after `last` and must be dropped: the difference of their sequence
// numbers is in (-20, 0] (section 6.7.2).
constexpr bool isLate(std::uint8_t sequence, std::uint8_t last) {
    const auto difference = static_cast<std::int8_t>(sequence - last);
    return difference <= 0 && difference > -20;
}

}  // namespace fantascope::drivers::sacn
