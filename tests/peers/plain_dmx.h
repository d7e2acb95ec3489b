#pragma once
// sACN and Art-Net by the test itself, independent of the program's packets: bytes and offsets
// written by hand from ANSI E1.31-2018 and the Art-Net 4 specification.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fantascope::peers {

using Datagram = std::vector<std::uint8_t>;
using Slots = std::array<std::uint8_t, 512>;

struct PlainLevels {
    int universe = 0, sequence = 0, priority = 100, options = 0, sync = 0;
    Slots slots{};
    std::string cid = {}, name = {};  // 16 bytes; of the source
};

inline Datagram plainSacn(const PlainLevels& levels) {
    Datagram bytes = {0x00, 0x10, 0, 0, 'A', 'S', 'C', '-', 'E', '1', '.', '1', '7', 0, 0, 0, 0x72, 0x6e, 0, 0, 0, 4};
    bytes.insert(bytes.end(), levels.cid.begin(), levels.cid.end());
    for (const int byte : {0x72, 0x58, 0, 0, 0, 2}) bytes.push_back(static_cast<std::uint8_t>(byte));
    bytes.insert(bytes.end(), levels.name.begin(), levels.name.end());
    bytes.resize(108);
    for (const int byte : {levels.priority, levels.sync >> 8, levels.sync & 255, levels.sequence & 255, levels.options,
                           levels.universe >> 8, levels.universe & 255, 0x72, 0x0b, 2, 0xa1, 0, 0, 0, 1, 2, 1, 0})
        bytes.push_back(static_cast<std::uint8_t>(byte));
    bytes.insert(bytes.end(), levels.slots.begin(), levels.slots.end());
    return bytes;
}

inline Datagram plainSacnSync(const std::string& cid, int universe, int sequence) {
    Datagram bytes = {0x00, 0x10, 0, 0, 'A', 'S', 'C', '-', 'E', '1', '.', '1', '7', 0, 0, 0, 0x70, 0x21, 0, 0, 0, 8};
    bytes.insert(bytes.end(), cid.begin(), cid.end());
    for (const int byte : {0x70, 0x0b, 0, 0, 0, 1, sequence, universe >> 8, universe & 255, 0, 0})
        bytes.push_back(static_cast<std::uint8_t>(byte));
    return bytes;
}

// Nothing if it is not a packet of levels.
inline std::optional<PlainLevels> readPlainSacn(std::span<const std::uint8_t> bytes) {
    if (bytes.size() != 638 || bytes[21] != 4 || bytes[43] != 2) return std::nullopt;
    PlainLevels levels;
    levels.cid.assign(bytes.begin() + 22, bytes.begin() + 38);
    levels.name.assign(reinterpret_cast<const char*>(bytes.data()) + 44);
    levels.priority = bytes[108];
    levels.sync = bytes[109] << 8 | bytes[110];
    levels.sequence = bytes[111];
    levels.options = bytes[112];
    levels.universe = bytes[113] << 8 | bytes[114];
    for (std::size_t slot = 0; slot < 512; ++slot) levels.slots[slot] = bytes[126 + slot];
    return levels;
}

inline std::string sacnGroup(int universe) {
    return "239.255." + std::to_string(universe >> 8) + "." + std::to_string(universe & 255);
}

inline Datagram plainArtDmx(const PlainLevels& levels) {
    Datagram bytes = {'A', 'r', 't', '-', 'N', 'e', 't', 0, 0x00, 0x50, 0, 14};
    for (const int byte : {levels.sequence, 0, levels.universe & 255, levels.universe >> 8, 2, 0})
        bytes.push_back(static_cast<std::uint8_t>(byte));
    bytes.insert(bytes.end(), levels.slots.begin(), levels.slots.end());
    return bytes;
}

inline std::optional<PlainLevels> readPlainArtDmx(std::span<const std::uint8_t> bytes) {
    if (bytes.size() != 530 || bytes[8] != 0x00 || bytes[9] != 0x50) return std::nullopt;
    PlainLevels levels;
    levels.sequence = bytes[12];
    levels.universe = bytes[15] << 8 | bytes[14];
    for (std::size_t slot = 0; slot < 512; ++slot) levels.slots[slot] = bytes[18 + slot];
    return levels;
}

inline bool isArtPoll(std::span<const std::uint8_t> bytes) { return bytes.size() >= 14 && bytes[8] == 0x00 && bytes[9] == 0x20; }
inline bool isArtPollReply(std::span<const std::uint8_t> bytes) {
    return bytes.size() >= 207 && bytes[8] == 0x00 && bytes[9] == 0x21;
}
inline bool isArtSync(std::span<const std::uint8_t> bytes) { return bytes.size() == 14 && bytes[8] == 0x00 && bytes[9] == 0x52; }

inline Datagram plainArtSync() { return {'A', 'r', 't', '-', 'N', 'e', 't', 0, 0x00, 0x52, 0, 14, 0, 0}; }
inline Datagram plainArtPoll() { return {'A', 'r', 't', '-', 'N', 'e', 't', 0, 0x00, 0x20, 0, 14, 0, 0}; }

// A node at 10.77.0.2 with one output on the port-address 0x123.
inline Datagram plainArtPollReply() {
    Datagram bytes(239);
    const Datagram start = {'A', 'r', 't', '-', 'N', 'e', 't', 0, 0x00, 0x21, 10, 77, 0, 2, 0x36, 0x19};
    std::copy(start.begin(), start.end(), bytes.begin());
    bytes[18] = 1;
    bytes[19] = 2;
    const std::string name = "Dimmer", longName = "Dimmer of the test";
    std::copy(name.begin(), name.end(), bytes.begin() + 26);
    std::copy(longName.begin(), longName.end(), bytes.begin() + 44);
    bytes[173] = 1;
    bytes[174] = 0x80;
    bytes[190] = 3;
    bytes[211] = 1;
    return bytes;
}

}  // namespace fantascope::peers
