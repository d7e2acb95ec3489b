#pragma once
// What the descriptors of common controllers lack.

#include "drivers/cue_controller/hid_buttons.h"
#include "drivers/cue_controller/hid_lamps.h"

#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace fantascope::drivers {

struct HidProfile {
    std::string_view name;  // as in the site file
    std::string_view what;
    std::vector<std::pair<std::uint16_t, std::uint16_t>> devices;  // vendor, product
    std::vector<HidUsage> firstKeys;                               // these keys become buttons 1, 2, ...
    std::vector<HidControl> controls;                              // the controls in its reports, if the descriptor lacks them
    HidLampKind lamps{};
};

// All profiles.
std::span<const HidProfile> hidProfiles();

// Null: none.
const HidProfile* hidProfileOf(std::uint16_t vendor, std::uint16_t product);
const HidProfile* hidProfileNamed(std::string_view name);

// A device's buttons, from its profile or its descriptors. `profile` may be null.
HidLayout layoutOf(const std::vector<HidInterface>& interfaces, const HidProfile* profile);

}  // namespace fantascope::drivers
