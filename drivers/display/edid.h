#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace fantascope::drivers {

// What a monitor says of itself, by which it is known again on any connector. A part that it does
// not tell is empty.
struct MonitorIdentity {
    std::string make;    // the three letters of its PNP id: "EPS"
    std::string model;   // its product name; the product code as 0x and four hexadecimal digits where it has no name
    std::string serial;  // its serial number's text; the 32-bit number in decimal where it has no text
    bool operator==(const MonitorIdentity&) const = default;
};

// Reads the base block of an EDID (VESA E-EDID Standard, Release A, Revision 2, section 3).
// Extensions after it are not looked at.
// Nothing: it is too short, or its header or checksum is broken, so that no part of it can be
// trusted.
std::optional<MonitorIdentity> identityFromEdid(std::span<const std::uint8_t> edid);

}  // namespace fantascope::drivers
