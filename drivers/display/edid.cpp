#include "drivers/display/edid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace fantascope::drivers {
namespace {

constexpr std::size_t kBlock = 128;
constexpr std::array<std::uint8_t, 8> kHeader = {0, 255, 255, 255, 255, 255, 255, 0};
constexpr std::size_t kMake = 8, kProduct = 10, kSerial = 12;
constexpr std::array<std::size_t, 4> kDescriptors = {54, 72, 90, 108};
constexpr std::uint8_t kSerialText = 0xFF, kNameText = 0xFC;

// The lowest 15 bits hold three letters of five bits each; A is 1. Empty if they are not letters.
std::string letters(std::span<const std::uint8_t> edid) {
    const unsigned bits = edid[kMake] << 8 | edid[kMake + 1];
    std::string make;
    for (const unsigned shift : {10, 5, 0}) {
        const unsigned letter = bits >> shift & 31;
        if (letter < 1 || letter > 26) return "";
        make += static_cast<char>('A' + letter - 1);
    }
    return make;
}

// The text of the first descriptor of a kind. It ends at a line feed, padded with spaces; some
// makers put other bytes there.
std::string textOf(std::span<const std::uint8_t> edid, std::uint8_t kind) {
    for (const std::size_t at : kDescriptors) {
        const auto descriptor = edid.subspan(at, 18);
        if (descriptor[0] != 0 || descriptor[1] != 0 || descriptor[3] != kind) continue;
        std::string text;
        for (const std::uint8_t letter : descriptor.subspan(5)) {
            if (letter == '\n') break;
            if (letter >= ' ' && letter <= '~') text += static_cast<char>(letter);
        }
        const std::size_t first = text.find_first_not_of(' ');
        if (first == std::string::npos) continue;
        return text.substr(first, text.find_last_not_of(' ') + 1 - first);
    }
    return "";
}

}  // namespace

std::optional<MonitorIdentity> identityFromEdid(std::span<const std::uint8_t> edid) {
    if (edid.size() < kBlock || !std::equal(kHeader.begin(), kHeader.end(), edid.begin())) return std::nullopt;
    edid = edid.first(kBlock);
    if (std::accumulate(edid.begin(), edid.end(), 0u) % 256 != 0) return std::nullopt;

    MonitorIdentity identity{letters(edid), textOf(edid, kNameText), textOf(edid, kSerialText)};
    if (identity.model.empty()) identity.model = fmt::format("0x{:02X}{:02X}", edid[kProduct + 1], edid[kProduct]);
    const std::uint32_t number =
        edid[kSerial] | edid[kSerial + 1] << 8 | edid[kSerial + 2] << 16 | static_cast<std::uint32_t>(edid[kSerial + 3]) << 24;
    if (identity.serial.empty() && number != 0) identity.serial = std::to_string(number);  // 0: none
    return identity;
}

}  // namespace fantascope::drivers
