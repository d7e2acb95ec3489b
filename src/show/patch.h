#pragma once
// From the levels and relays of a look to what the lines of the site carry.

#include "show/show_state.h"
#include "show/site/site.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::show {

// Fills the 512 slots of one universe; out[0] is address 1. A level goes straight to its slot,
// linearly, 0..1 to 0..255, rounded to the nearest; whatever curve the dimmer has is its own. Slots
// without a fixture are 0.
void slotsOf(const Site& site, const Look& look, int universe, std::span<std::uint8_t, 512> out);

// The levels of a Look when the show is over.
std::vector<float> endLevels(const Site& site);

// The states of a relay bank's coils, site.coilCount(bank) of them, from coil 0; true is on. Coils
// without a relay are off.
std::vector<bool> coilsOf(const Site& site, const Look& look, std::size_t bank);

// The safe states of the same coils.
std::vector<bool> safeCoils(const Site& site, std::size_t bank);

}  // namespace fantascope::show
