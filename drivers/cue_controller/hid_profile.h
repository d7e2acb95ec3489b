#pragma once
// What the descriptors of common controllers leave out.

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
    std::vector<HidUsage> leading;                                 // these keys are buttons 1, 2, ...
    std::vector<HidControl> controls;  // what the reports hold, where their descriptor does not say it
    HidLampKind lamps{};
};

// Every profile of the program.
std::span<const HidProfile> hidProfiles();

// Null: none is known.
const HidProfile* hidProfileOf(std::uint16_t vendor, std::uint16_t product);
const HidProfile* hidProfileNamed(std::string_view name);

// A device's buttons by its descriptors, and by its profile where it has one (`profile` may be
// null).
HidLayout layoutOf(const std::vector<HidInterface>& interfaces, const HidProfile* profile);

}  // namespace fantascope::drivers
