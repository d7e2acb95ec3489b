#include "show/patch.h"

#include "show/site/light_channels.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>

namespace fantascope::show {

void slotsOf(const Site& site, const Look& look, int universe, std::span<std::uint8_t, 512> out) {
    FANTASCOPE_CHECK(look.levels.size() == site.channelCount(), "the look is for this site");
    std::fill(out.begin(), out.end(), std::uint8_t{0});
    auto level = look.levels.begin();
    for (const Fixture& fixture : site.fixtures) {
        const auto next = level + static_cast<std::ptrdiff_t>(fixture.channels.size());
        if (fixture.universe == universe)
            std::transform(level, next, out.begin() + (fixture.address - 1), [](float value) {
                return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
            });
        level = next;
    }
}

void applyTrim(const Site& site, const LampTrim& trim, Look& look) {
    const Corrections::Lamps& lamps = site.corrections.lamps;
    for (const std::size_t fixture : lamps.fixtures)
        for (std::size_t channel = 0; channel < site.fixtures[fixture].channels.size(); ++channel)
            if (scalesLight(site.fixtures[fixture], channel)) look.levels[site.firstLevel(fixture) + channel] *= trim.share;
    for (std::size_t i = 0; i < lamps.relays.size() && static_cast<int>(i) < trim.relaysOff; ++i)
        look.relays[lamps.relays[i]] = 0;
}

std::vector<float> endLevels(const Site& site) {
    std::vector<float> levels;
    for (const Fixture& fixture : site.fixtures) {
        std::vector<float> own = fixture.end;
        own.resize(fixture.channels.size());
        levels.insert(levels.end(), own.begin(), own.end());
    }
    return levels;
}

std::vector<bool> coilsOf(const Site& site, const Look& look, std::size_t bank) {
    FANTASCOPE_CHECK(look.relays.size() == site.relays.size(), "the look is for this site");
    std::vector<bool> states(site.coilCount(bank), false);
    for (std::size_t i = 0; i < site.relays.size(); ++i)
        if (site.relays[i].bank == bank) states[static_cast<std::size_t>(site.relays[i].coil)] = look.relays[i] != 0;
    return states;
}

std::vector<bool> safeCoils(const Site& site, std::size_t bank) {
    std::vector<bool> states(site.coilCount(bank), false);
    for (const Relay& relay : site.relays)
        if (relay.bank == bank) states[static_cast<std::size_t>(relay.coil)] = relay.safe;
    return states;
}

}  // namespace fantascope::show
