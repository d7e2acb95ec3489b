#include "drivers/dmx/artnet_packet.h"

#include "core/check.h"

#include <algorithm>
#include <string_view>

namespace fantascope::drivers::artnet {
namespace {

constexpr std::array<std::uint8_t, 8> kId = {'A', 'r', 't', '-', 'N', 'e', 't', 0};
constexpr std::uint16_t kOpPoll = 0x2000, kOpPollReply = 0x2100, kOpDmx = 0x5000, kOpSync = 0x5200;
constexpr std::uint8_t kVersion = 14;
constexpr std::size_t kOpCode = 8, kProtocol = 10, kFlags = 12;

// ArtDmx.
constexpr std::size_t kSequence = 12, kSubUni = 14, kNet = 15, kLength = 16, kSlots = 18;
// ArtPollReply.
constexpr std::size_t kAddress = 10, kPort = 14, kNetSwitch = 18, kSubSwitch = 19, kOem = 20, kEsta = 24, kShortName = 26;
constexpr std::size_t kLongName = 44, kReport = 108, kPortCount = 173, kPortTypes = 174, kGoodInput = 178, kGoodOutput = 182;
constexpr std::size_t kSwIn = 186, kSwOut = 190, kStyle = 200, kHardware = 201, kBindAddress = 207, kBindIndex = 211;
constexpr std::size_t kStatus2 = 212, kMinReply = 207;  // bytes; older nodes leave out the fields that came with binding
constexpr std::size_t kShortSize = 18, kLongSize = 64, kPorts = 4;
constexpr std::uint8_t kPortOut = 0x80, kPortIn = 0x40, kActive = 0x80, kController = 1, kReplyOnChange = 0x02;
constexpr std::uint8_t kWidePortAddress = 0x08;  // of Status2

using Bytes = std::span<const std::uint8_t>;

void begin(std::span<std::uint8_t> bytes, std::uint16_t opCode) {
    std::copy(kId.begin(), kId.end(), bytes.begin());
    bytes[kOpCode] = static_cast<std::uint8_t>(opCode);
    bytes[kOpCode + 1] = static_cast<std::uint8_t>(opCode >> 8);
    if (opCode != kOpPollReply) bytes[kProtocol + 1] = kVersion;
}

std::string textIn(Bytes bytes, std::size_t at, std::size_t size) {
    const Bytes text = bytes.subspan(at, size);
    return {text.begin(), std::find(text.begin(), text.end(), 0)};
}
void putText(std::span<std::uint8_t> bytes, std::size_t at, std::size_t size, std::string_view text) {
    std::copy_n(text.begin(), std::min(text.size(), size - 1), bytes.begin() + static_cast<std::ptrdiff_t>(at));
}
void putAddress(std::span<std::uint8_t> bytes, std::size_t at, Ipv4 address) {
    for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(address.bits >> (24 - 8 * i));
}

std::optional<Packet> readDmx(Bytes bytes) {
    if (bytes.size() < kSlots) return std::nullopt;
    const std::size_t length = static_cast<std::size_t>(bytes[kLength] << 8 | bytes[kLength + 1]);
    if (length < 1 || length > kDmxSlots || bytes.size() < kSlots + length || bytes[kNet] > 127) return std::nullopt;
    Dmx dmx{bytes[kSequence], bytes[kNet] << 8 | bytes[kSubUni], {}};
    std::copy_n(bytes.begin() + kSlots, length, dmx.slots.begin());
    return dmx;
}

std::optional<Packet> readReply(Bytes bytes) {
    if (bytes.size() < kMinReply) return std::nullopt;
    PollReply reply;
    for (std::size_t i = 0; i < 4; ++i) reply.address.bits = reply.address.bits << 8 | bytes[kAddress + i];
    std::copy_n(bytes.begin() + kHardware, reply.hardware.size(), reply.hardware.begin());
    reply.shortName = textIn(bytes, kShortName, kShortSize);
    reply.longName = textIn(bytes, kLongName, kLongSize);
    reply.controller = bytes[kStyle] == kController;
    reply.bindIndex = bytes.size() > kBindIndex ? bytes[kBindIndex] : 0;
    const int net = (bytes[kNetSwitch] & 0x7f) << 8 | (bytes[kSubSwitch] & 0x0f) << 4;
    for (std::size_t port = 0; port < std::min<std::size_t>(bytes[kPortCount], kPorts); ++port) {
        if (bytes[kPortTypes + port] & kPortOut) reply.outputs.push_back(net | (bytes[kSwOut + port] & 0x0f));
        if (bytes[kPortTypes + port] & kPortIn) reply.inputs.push_back(net | (bytes[kSwIn + port] & 0x0f));
    }
    return reply;
}

}  // namespace

std::optional<Packet> read(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < kFlags || !std::equal(kId.begin(), kId.end(), bytes.begin())) return std::nullopt;
    const int opCode = bytes[kOpCode + 1] << 8 | bytes[kOpCode];
    if (opCode == kOpPollReply) return readReply(bytes);
    if (bytes[kProtocol] == 0 && bytes[kProtocol + 1] < kVersion) return std::nullopt;
    if (opCode == kOpDmx) return readDmx(bytes);
    if (opCode == kOpSync) return Sync{};
    if (opCode == kOpPoll) return Poll{};
    return std::nullopt;
}

std::array<std::uint8_t, 530> bytesOf(const Dmx& dmx) {
    std::array<std::uint8_t, 530> bytes{};
    begin(bytes, kOpDmx);
    bytes[kSequence] = dmx.sequence;
    bytes[kSubUni] = static_cast<std::uint8_t>(dmx.portAddress);
    bytes[kNet] = static_cast<std::uint8_t>(dmx.portAddress >> 8);
    bytes[kLength] = kDmxSlots >> 8;
    bytes[kLength + 1] = kDmxSlots & 255;
    std::copy(dmx.slots.begin(), dmx.slots.end(), bytes.begin() + kSlots);
    return bytes;
}

std::array<std::uint8_t, 14> bytesOf(Sync) {
    std::array<std::uint8_t, 14> bytes{};
    begin(bytes, kOpSync);
    return bytes;
}

std::array<std::uint8_t, 14> bytesOf(Poll) {
    std::array<std::uint8_t, 14> bytes{};
    begin(bytes, kOpPoll);
    bytes[kFlags] = kReplyOnChange;
    return bytes;
}

std::array<std::uint8_t, 239> bytesOf(const PollReply& reply) {
    FANTASCOPE_CHECK(reply.outputs.size() <= kPorts && reply.inputs.size() <= kPorts, "a reply describes at most four ports");
    std::array<std::uint8_t, 239> bytes{};
    begin(bytes, kOpPollReply);
    putAddress(bytes, kAddress, reply.address);
    bytes[kPort] = kUdpPort & 255;
    bytes[kPort + 1] = kUdpPort >> 8;
    bytes[kOem + 1] = 0xff;  // a maker without a code of its own; the ESTA code is one for prototypes
    bytes[kEsta] = 0xf0;
    bytes[kEsta + 1] = 0x7f;
    putText(bytes, kShortName, kShortSize, reply.shortName);
    putText(bytes, kLongName, kLongSize, reply.longName);
    putText(bytes, kReport, kLongSize, "#0001 [0000] ok");
    const auto portAddress = [&] {
        if (!reply.outputs.empty()) return reply.outputs.front();
        return reply.inputs.empty() ? 0 : reply.inputs.front();
    }();
    bytes[kNetSwitch] = static_cast<std::uint8_t>(portAddress >> 8);
    bytes[kSubSwitch] = static_cast<std::uint8_t>(portAddress >> 4 & 0x0f);
    bytes[kPortCount] = static_cast<std::uint8_t>(std::max(reply.outputs.size(), reply.inputs.size()));
    for (std::size_t port = 0; port < reply.outputs.size(); ++port) {
        bytes[kPortTypes + port] |= kPortOut;
        bytes[kGoodOutput + port] = kActive;
        bytes[kSwOut + port] = static_cast<std::uint8_t>(reply.outputs[port] & 0x0f);
    }
    for (std::size_t port = 0; port < reply.inputs.size(); ++port) {
        bytes[kPortTypes + port] |= kPortIn;
        bytes[kGoodInput + port] = kActive;
        bytes[kSwIn + port] = static_cast<std::uint8_t>(reply.inputs[port] & 0x0f);
    }
    bytes[kStyle] = reply.controller ? kController : 0;
    std::copy(reply.hardware.begin(), reply.hardware.end(), bytes.begin() + kHardware);
    putAddress(bytes, kBindAddress, reply.address);
    bytes[kBindIndex] = static_cast<std::uint8_t>(reply.bindIndex);
    bytes[kStatus2] = kWidePortAddress;
    return bytes;
}

}  // namespace fantascope::drivers::artnet
