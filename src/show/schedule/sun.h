#pragma once

#include "core/clock.h"

#include <array>
#include <optional>
#include <string_view>

namespace fantascope::show {

// What the sun does in the evening, and then in the morning. The sun's upper edge is at the
// horizon, or the middle of the sun is 6, 12 or 18 degrees below it.
enum class SunEvent { Sunset, CivilDusk, NauticalDusk, AstronomicalDusk, AstronomicalDawn, NauticalDawn, CivilDawn, Sunrise };

constexpr std::array<std::string_view, 8> kSunEvents = {
    "sunset", "civil dusk", "nautical dusk", "astronomical dusk", "astronomical dawn", "nautical dawn", "civil dawn", "sunrise"};

// When the sun does so in the night after the noon nearest to `noon` (UTC); nothing: not in that
// night, as near the poles. `latitude`, `longitude`: radians, north and east.
// From the sun's position by Meeus, "Astronomical Algorithms", 2nd ed. 1998, chapters 12 and 25
// (.01 degrees), with the refraction at the horizon of chapter 15 (34'). The horizon is level, and
// the air is usual; hills and weather may change a sunset by minutes.
std::optional<Time> timeOf(SunEvent event, Time noon, double latitude, double longitude);

}  // namespace fantascope::show
