#include "show/site/light_channels.h"

#include <algorithm>
#include <array>
#include <string>

namespace fantascope::show {

bool isColour(std::string_view channel) {
    constexpr std::array<std::string_view, 5> kColours = {"red", "green", "blue", "white", "amber"};
    return std::ranges::find(kColours, channel) != kColours.end();
}

bool scalesLight(const Fixture& fixture, std::size_t channel) {
    constexpr std::string_view kIntensity = "intensity";
    const std::string& name = fixture.channels[channel];
    const bool hasIntensity = std::ranges::find(fixture.channels, kIntensity) != fixture.channels.end();
    return hasIntensity ? name == kIntensity : isColour(name);
}

}  // namespace fantascope::show
