#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope {

// What a test's monitor is called. Empty texts: it has no descriptor of that kind.
struct EdidParts {
    std::string_view make = "EPS", name = "EPSON PJ", serial = "X4XX";
    std::uint16_t product = 0xA123;
    std::uint32_t number = 0;  // the serial number that is no text
};

inline void setEdidChecksum(std::vector<std::uint8_t>& edid) {
    unsigned sum = 0;
    for (std::size_t i = 0; i < 127; ++i) sum += edid[i];
    edid[127] = static_cast<std::uint8_t>(256 - sum % 256);
}

// The 128 bytes that such a projector sends: EDID 1.3, with one timing of 1920 x 1080 at 60 Hz, as
// real ones have.
inline std::vector<std::uint8_t> edidBlock(const EdidParts& parts) {
    std::vector<std::uint8_t> edid = {
        0,  255, 255, 255, 255,  255, 255, 0,    0,    0,    0,    0,    0,    0,    0,    0,  //
        33, 29,  1,   3,   0x80, 0,   0,   0x78, 0x0A, 0xEE, 0x91, 0xA3, 0x54, 0x4C, 0x99, 0x26, 0x0F, 0x50, 0x54, 0x21, 0x08, 0};
    edid.resize(54, 1);  // standard timings that are not used
    const std::vector<std::uint8_t> timing = {0x02, 0x3A, 0x80, 0x18, 0x71, 0x38, 0x2D, 0x40, 0x58,
                                              0x2C, 0x45, 0,    0,    0,    0,    0,    0,    0x1E};
    edid.insert(edid.end(), timing.begin(), timing.end());
    const auto text = [&](std::uint8_t kind, std::string_view letters) {
        const std::size_t begin = edid.size();
        edid.insert(edid.end(), {0, 0, 0, letters.empty() ? std::uint8_t{0x10} : kind, 0});  // 0x10: a dummy
        edid.insert(edid.end(), letters.begin(), letters.end());
        if (letters.size() < 13) edid.push_back('\n');
        edid.resize(begin + 18, ' ');
    };
    text(0xFC, parts.name);
    text(0xFF, parts.serial);
    const std::vector<std::uint8_t> limits = {0, 0, 0, 0xFD, 0, 24, 85, 15, 92, 30, 0, '\n', ' ', ' ', ' ', ' ', ' ', ' '};
    edid.insert(edid.end(), limits.begin(), limits.end());
    edid.resize(128);

    unsigned make = 0;
    for (const char letter : parts.make) make = make << 5 | static_cast<unsigned>(letter - 'A' + 1);
    edid[8] = static_cast<std::uint8_t>(make >> 8);
    edid[9] = static_cast<std::uint8_t>(make);
    edid[10] = static_cast<std::uint8_t>(parts.product);
    edid[11] = static_cast<std::uint8_t>(parts.product >> 8);
    for (int i = 0; i < 4; ++i) edid[static_cast<std::size_t>(12 + i)] = static_cast<std::uint8_t>(parts.number >> 8 * i);
    setEdidChecksum(edid);
    return edid;
}

}  // namespace fantascope
