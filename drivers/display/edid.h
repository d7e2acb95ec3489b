#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace fantascope::drivers {

// A monitor's description of itself, which identifies it on any connector. Fields that it does not
// report are empty.
struct MonitorIdentity {
    std::string make;    // the three letters of its PNP id: "EPS"
    std::string model;   // its product name; without one, the product code as 0x and four hexadecimal digits
    std::string serial;  // its serial number as text; without one, the 32-bit number in decimal
    bool operator==(const MonitorIdentity&) const = default;
};

// Reads the base block of an EDID (VESA E-EDID Standard, Release A, Revision 2, section 3).
// Extensions are ignored.
// Nothing if it is too short, or its header or checksum is wrong, so that no part can be trusted.
std::optional<MonitorIdentity> identityFromEdid(std::span<const std::uint8_t> edid);

}  // namespace fantascope::drivers
