#include "drivers/dmx/sacn_packet.h"

#include "core/check.h"
#include "core/random.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace fantascope::drivers::sacn {
namespace {

// Offsets from tables 4-1 to 4-3. Each layer begins with its flags and length; the length counts
// from there to the packet's end.
constexpr std::size_t kRootLayer = 16, kRootVector = 18, kCid = 22, kFraming = 38, kFramingVector = 40;
constexpr std::size_t kName = 44, kPriority = 108, kSyncAddress = 109, kSequence = 111, kOptions = 112, kUniverse = 113;
constexpr std::size_t kDmp = 115, kDmpVector = 117, kCount = 123, kStartCode = 125, kSlots = 126;
constexpr std::size_t kSyncSequence = 44, kSyncUniverse = 45;
constexpr std::size_t kList = 112, kListVector = 114, kPage = 118, kLastPage = 119, kUniverses = 120;

constexpr std::uint32_t kRootData = 4, kRootExtended = 8;
constexpr std::uint32_t kFramingData = 2, kFramingSync = 1, kFramingDiscovery = 2, kListOfUniverses = 1;
constexpr std::uint8_t kDmpSet = 2, kPreview = 0x80, kTerminated = 0x40, kForce = 0x20;

constexpr std::array<std::uint8_t, kRootLayer> kPreamble = {0, 0x10, 0, 0, 'A', 'S', 'C', '-', 'E', '1', '.', '1', '7', 0, 0, 0};
constexpr std::array<std::uint8_t, 5> kAllSlots = {0xa1, 0, 0, 0, 1};  // two-byte addresses, from 0, in steps of 1

using Bytes = std::span<const std::uint8_t>;

std::uint16_t word(Bytes bytes, std::size_t at) { return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]); }
std::uint32_t doubleWord(Bytes bytes, std::size_t at) {
    return static_cast<std::uint32_t>(word(bytes, at)) << 16 | word(bytes, at + 2);
}
void put(std::span<std::uint8_t> bytes, std::size_t at, std::uint32_t value, std::size_t count) {
    for (; count > 0; --count, value >>= 8) bytes[at + count - 1] = static_cast<std::uint8_t>(value);
}
void putLayer(std::span<std::uint8_t> bytes, std::size_t at) {
    put(bytes, at, 0x7000 | static_cast<std::uint32_t>(bytes.size() - at), 2);
}
// Whether a layer's flags and length match the received bytes. Bytes after the packet are ignored
// (section 5.4 of E1.17).
bool holdsLayer(Bytes bytes, std::size_t at, std::size_t least) {
    if (bytes.size() < at + 2 || bytes[at] >> 4 != 7) return false;
    const std::size_t length = word(bytes, at) & 0x0fff;
    return length >= least && at + length <= bytes.size();
}

std::string nameIn(Bytes bytes) {
    const Bytes name = bytes.subspan(kName, kNameSize);
    return {name.begin(), std::find(name.begin(), name.end(), 0)};
}
void putName(std::span<std::uint8_t> bytes, std::string_view name) {
    std::copy_n(name.begin(), std::min(name.size(), kNameSize - 1), bytes.begin() + kName);
}

void putRoot(std::span<std::uint8_t> bytes, std::uint32_t vector, const Cid& cid, std::uint32_t framing) {
    std::copy(kPreamble.begin(), kPreamble.end(), bytes.begin());
    putLayer(bytes, kRootLayer);
    put(bytes, kRootVector, vector, 4);
    std::copy(cid.begin(), cid.end(), bytes.begin() + kCid);
    putLayer(bytes, kFraming);
    put(bytes, kFramingVector, framing, 4);
}

std::optional<Packet> readData(Bytes bytes, const Cid& cid) {
    if (doubleWord(bytes, kFramingVector) != kFramingData || !holdsLayer(bytes, kDmp, kStartCode + 1 - kDmp)) return std::nullopt;
    if (bytes[kDmpVector] != kDmpSet || !std::equal(kAllSlots.begin(), kAllSlots.end(), bytes.begin() + kDmpVector + 1))
        return std::nullopt;
    const std::size_t count = word(bytes, kCount), length = word(bytes, kDmp) & 0x0fff;
    if (count < 1 || count > kDmxSlots + 1 || kStartCode - kDmp + count > length) return std::nullopt;
    Data data;
    data.cid = cid;
    data.name = nameIn(bytes);
    data.priority = bytes[kPriority];
    data.sync = word(bytes, kSyncAddress);
    data.sequence = bytes[kSequence];
    data.preview = bytes[kOptions] & kPreview;
    data.terminated = bytes[kOptions] & kTerminated;
    data.force = bytes[kOptions] & kForce;
    data.universe = word(bytes, kUniverse);
    data.startCode = bytes[kStartCode];
    std::copy_n(bytes.begin() + kSlots, count - 1, data.slots.begin());
    if (data.priority > 200 || data.universe < 1 || data.universe > kLastUniverse || data.sync > kLastUniverse)
        return std::nullopt;
    return data;
}

std::optional<Packet> readSync(Bytes bytes, const Cid& cid) {
    return Sync{cid, bytes[kSyncSequence], word(bytes, kSyncUniverse)};
}

std::optional<Packet> readDiscovery(Bytes bytes, const Cid& cid) {
    if (!holdsLayer(bytes, kList, kUniverses - kList) || doubleWord(bytes, kListVector) != kListOfUniverses) return std::nullopt;
    Discovery discovery{cid, nameIn(bytes), bytes[kPage], bytes[kLastPage], {}};
    const std::size_t end = kList + (word(bytes, kList) & 0x0fff);
    for (std::size_t at = kUniverses; at + 2 <= end; at += 2) discovery.universes.push_back(word(bytes, at));
    if (discovery.universes.size() > kUniversesOnPage) return std::nullopt;
    return discovery;
}

}  // namespace

std::string textOf(const Cid& cid) {
    std::string text;
    for (std::size_t i = 0; i < cid.size(); ++i)
        text += fmt::format("{}{:02x}", i == 4 || i == 6 || i == 8 || i == 10 ? "-" : "", cid[i]);
    return text;
}

Cid cidFor(std::string_view name) {
    std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a
    for (const char letter : name) hash = (hash ^ static_cast<std::uint8_t>(letter)) * 0x100000001b3;
    Cid cid;
    for (std::size_t half = 0; half < 2; ++half) {
        const std::uint64_t bits = streamSeed(hash, {half});
        for (std::size_t i = 0; i < 8; ++i) cid[8 * half + i] = static_cast<std::uint8_t>(bits >> (8 * i));
    }
    cid[6] = (cid[6] & 0x0f) | 0x80;
    cid[8] = (cid[8] & 0x3f) | 0x80;
    return cid;
}

std::optional<Packet> read(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < std::tuple_size_v<SyncBytes> || !std::equal(kPreamble.begin(), kPreamble.end(), bytes.begin()))
        return std::nullopt;
    if (!holdsLayer(bytes, kRootLayer, std::tuple_size_v<SyncBytes> - kRootLayer)) return std::nullopt;
    bytes = bytes.first(kRootLayer + (word(bytes, kRootLayer) & 0x0fff));
    if (!holdsLayer(bytes, kFraming, std::tuple_size_v<SyncBytes> - kFraming)) return std::nullopt;
    Cid cid;
    std::copy_n(bytes.begin() + kCid, cid.size(), cid.begin());
    const std::uint32_t root = doubleWord(bytes, kRootVector), framing = doubleWord(bytes, kFramingVector);
    if (root == kRootData && bytes.size() > kStartCode) return readData(bytes, cid);
    if (root == kRootExtended && framing == kFramingSync) return readSync(bytes, cid);
    if (root == kRootExtended && framing == kFramingDiscovery && bytes.size() >= kUniverses) return readDiscovery(bytes, cid);
    return std::nullopt;
}

DataBytes bytesOf(const Data& data) {
    DataBytes bytes{};
    putRoot(bytes, kRootData, data.cid, kFramingData);
    putName(bytes, data.name);
    bytes[kPriority] = static_cast<std::uint8_t>(data.priority);
    put(bytes, kSyncAddress, static_cast<std::uint32_t>(data.sync), 2);
    bytes[kSequence] = data.sequence;
    bytes[kOptions] = static_cast<std::uint8_t>((data.preview ? kPreview : 0) | (data.terminated ? kTerminated : 0) |
                                                (data.force ? kForce : 0));
    put(bytes, kUniverse, static_cast<std::uint32_t>(data.universe), 2);
    putLayer(bytes, kDmp);
    bytes[kDmpVector] = kDmpSet;
    std::copy(kAllSlots.begin(), kAllSlots.end(), bytes.begin() + kDmpVector + 1);
    put(bytes, kCount, kDmxSlots + 1, 2);
    bytes[kStartCode] = data.startCode;
    std::copy(data.slots.begin(), data.slots.end(), bytes.begin() + kSlots);
    return bytes;
}

SyncBytes bytesOf(const Sync& sync) {
    SyncBytes bytes{};
    putRoot(bytes, kRootExtended, sync.cid, kFramingSync);
    bytes[kSyncSequence] = sync.sequence;
    put(bytes, kSyncUniverse, static_cast<std::uint32_t>(sync.universe), 2);
    return bytes;
}

std::vector<std::uint8_t> bytesOf(const Discovery& discovery) {
    FANTASCOPE_CHECK(discovery.universes.size() <= kUniversesOnPage, "a page holds kUniversesOnPage universes");
    std::vector<std::uint8_t> bytes(kUniverses + 2 * discovery.universes.size());
    putRoot(bytes, kRootExtended, discovery.cid, kFramingDiscovery);
    putName(bytes, discovery.name);
    putLayer(bytes, kList);
    put(bytes, kListVector, kListOfUniverses, 4);
    bytes[kPage] = static_cast<std::uint8_t>(discovery.page);
    bytes[kLastPage] = static_cast<std::uint8_t>(discovery.lastPage);
    for (std::size_t i = 0; i < discovery.universes.size(); ++i)
        put(bytes, kUniverses + 2 * i, static_cast<std::uint32_t>(discovery.universes[i]), 2);
    return bytes;
}

}  // namespace fantascope::drivers::sacn
