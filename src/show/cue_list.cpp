#include "show/cue_list.h"

#include <set>

namespace fantascope::show {

std::vector<Movement> CueList::Cue::movements(Time entered, Time at, Time least) const {
    // When a part of the cue begins to move, and how.
    struct Timing {
        Time start;
        Fade fade;
    };
    const auto timingOf = [&](Time waits, const Fade& own) {
        const Time begun = entered + waits;
        if (begun >= at) return Timing{begun, own};
        const auto rest = [&](Time length) { return std::max(begun + length - at, least); };
        return Timing{at, Fade(rest(own.in), rest(own.out), own.curve)};
    };
    // What has begun is not begun again.
    const std::vector<SourceId> again = entered + wait < at ? std::vector<SourceId>() : restarts;
    const Timing others = timingOf(wait, fade);
    std::vector<Timing> outputs(look.outputs.size(), others), levels(look.levels.size(), others),
        relays(look.relays.size(), others);
    struct Layer {
        Part::Layer which;
        Timing timing;
    };
    std::vector<Layer> layers;
    std::set<Time> starts = {others.start};
    for (const Part& part : parts) {
        const Timing own = timingOf(part.wait, part.fade);
        for (const std::size_t output : part.outputs) outputs[output] = own;
        for (const std::size_t level : part.levels) levels[level] = own;
        for (const std::size_t relay : part.relays) relays[relay] = own;
        for (const Part::Layer& layer : part.layers) layers.push_back({layer, own});
        starts.insert(own.start);
    }

    std::vector<Movement> movements;
    for (const Time start : starts) {
        const auto fadeNow = [&](const Timing& timing) {
            return timing.start == start ? std::optional(timing.fade) : std::nullopt;
        };
        Movement& movement = movements.emplace_back(Movement{.start = start});
        for (const Timing& timing : outputs) movement.outputs.push_back(fadeNow(timing));
        for (const Timing& timing : levels) movement.levels.push_back(fadeNow(timing));
        for (std::size_t relay = 0; relay < relays.size(); ++relay) {
            const bool tracks = relay < tracksRelays.size() && tracksRelays[relay] != 0;
            movement.relays.push_back(relays[relay].start != start ? Movement::Relay::Stays
                                      : tracks                     ? Movement::Relay::GoesOn
                                                                   : Movement::Relay::Switches);
        }
        for (const Layer& layer : layers)
            movement.layers.push_back({layer.which.output, layer.which.source, fadeNow(layer.timing)});
        movement.speeds = fadeNow(others);
        if (movement.speeds) movement.restarts = again;
    }
    return movements;
}

std::optional<Time> CueList::Cue::usualFollow() const {
    if (!follow || endings.empty()) return follow;
    Time over = std::max(kShortestLoop - *follow, length());
    for (const Ending& ending : endings) {
        const float speed = speedOf(ending.source);
        if (speed <= 0) return std::nullopt;
        over = std::max(over, wait + fromSeconds(seconds(ending.length) / static_cast<double>(speed)));
    }
    return over + *follow;
}

}  // namespace fantascope::show
