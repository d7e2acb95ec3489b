#pragma once
// Maps the levels of a look to DMX slots, and its relays to coils.

#include "show/show_state.h"
#include "show/site/site.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::show {

// Fills the 512 slots of one universe; out[0] is address 1. A level 0..1 becomes 0..255 linearly,
// rounded to the nearest. The dimmer applies its own curve. Slots without a fixture are 0.
void slotsOf(const Site& site, const Look& look, int universe, std::span<std::uint8_t, 512> out);

// Takes from a look what a trim takes from the site's lamps: levels of Corrections::Lamps::fixtures
// are scaled, and relays switched off. Nothing becomes brighter than the look asks.
void applyTrim(const Site& site, const LampTrim& trim, Look& look);

// The end levels of all fixtures, in the order of Look::levels.
std::vector<float> endLevels(const Site& site);

// The states of a relay bank's coils, site.coilCount(bank) of them, from coil 0; true is on. Coils
// without a relay are off.
std::vector<bool> coilsOf(const Site& site, const Look& look, std::size_t bank);

// The safe states of the same coils.
std::vector<bool> safeCoils(const Site& site, std::size_t bank);

}  // namespace fantascope::show
