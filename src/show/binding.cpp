#include "show/binding.h"

#include "show/names.h"

#include "core/random.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::show {

namespace {

constexpr std::uint64_t kSideStream = 0x6c15;  // of the show's seed: what follows in a side list

// The index in the site of a thing that the show calls by name.
template <class Wish>
Result<std::size_t> indexOf(const Named<Wish>& wanted, const std::vector<std::string>& known, std::string_view what,
                            const Site& site) {
    const auto index = findName(wanted.name, known, what);
    if (!index) return wanted.at.error(fmt::format("{} in {}", index.error().message(), site.file.string()));
    return *index;
}

// The outputs that a name means: one output, or all outputs of one canvas.
template <class Wish>
Result<std::vector<std::size_t>> outputsOf(const Named<Wish>& wanted, const Site& site) {
    std::vector<std::string> names = namesOf(site.outputs);
    if (const auto one = std::find(names.begin(), names.end(), wanted.name); one != names.end())
        return std::vector{static_cast<std::size_t>(one - names.begin())};
    std::vector<std::size_t> all = site.outputsOn(wanted.name);
    if (!all.empty()) return all;
    const std::size_t outputs = names.size();
    for (const Output& output : site.outputs)
        if (std::find(names.begin(), names.end(), output.canvas) == names.end()) names.push_back(output.canvas);
    return indexOf(wanted, names, names.size() > outputs ? "output or canvas" : "output", site).error();
}

// The look that names nothing.
Look darkLook(const Site& site) {
    Look look;
    look.outputs.resize(site.outputs.size());
    look.levels.assign(site.channelCount(), 0.0f);
    for (const Relay& relay : site.relays) look.relays.push_back(relay.safe);
    return look;
}

// Puts what a look names over another one. Names that the site does not have go to `faults`.
void putLook(const NamedLook& named, const Site& site, Look& look, ConfigFaults& faults) {
    // An output's own layers, set last, replace those of its canvas.
    for (const bool own : {false, true})
        for (const auto& output : named.outputs)
            if (const auto outputs = outputsOf(output, site)) {
                for (const std::size_t index : *outputs)
                    if ((site.outputs[index].name == output.name) == own) look.outputs[index] = output.wish.layers;
            } else if (own) {
                faults.add(outputs.error());
            }
    for (const auto& relay : named.relays)
        faults.take(indexOf(relay, namesOf(site.relays), "relay", site),
                    [&](std::size_t index) { look.relays[index] = relay.wish; });
    for (const auto& fixture : named.fixtures)
        faults.take(indexOf(fixture, namesOf(site.fixtures), "fixture", site), [&](std::size_t index) {
            const std::vector<std::string>& channels = site.fixtures[index].channels;
            const std::span<float> levels = std::span(look.levels).subspan(site.firstLevel(index), channels.size());
            if (const float* all = std::get_if<float>(&fixture.wish)) {
                std::fill(levels.begin(), levels.end(), *all);
                return;
            }
            const std::string what = fmt::format("channel of '{}'", fixture.name);
            for (const Named<float>& channel : std::get<NamedLook::ChannelLevels>(fixture.wish))
                faults.take(indexOf(channel, channels, what, site), [&](std::size_t slot) { levels[slot] = channel.wish; });
        });
}

// Puts the winds that a look names over others; one for each output of `site`.
void putWinds(const NamedLook& named, const Site& site, std::vector<WindWish>& winds) {
    if (named.wind) std::ranges::fill(winds, *named.wind);
    for (const bool own : {false, true})
        for (const auto& output : named.outputs)
            for (std::size_t i = 0; i < winds.size(); ++i)
                if (output.wish.wind && (own ? site.outputs[i].name : site.outputs[i].canvas) == output.name)
                    winds[i] = *output.wish.wind;
}

// Whether a source's layer comes and goes with the picture that it is composed in.
bool isComposed(SourceId source, const OutputState& output) {
    const auto composed = std::span(output.layers).subspan(addedLayers(output).size());
    return std::ranges::find(composed, source, &LayerState::source) != composed.end();
}

// Looks up what a part of a cue names. `look`: the cue's. Names that the site does not have, and
// layers that cannot move alone, go to `faults`.
CueList::Part boundPart(const CuePart& named, const Cue& cue, const Look& look, const Site& site, ConfigFaults& faults) {
    CueList::Part part{named.wait.value_or(cue.wait), named.fade.value_or(cue.fade)};
    std::vector<std::size_t> outputs;
    for (const CuePart::Name& name : named.outputs)
        faults.take(outputsOf(name, site),
                    [&](const std::vector<std::size_t>& found) { outputs.insert(outputs.end(), found.begin(), found.end()); });
    if (named.sources.empty()) {
        part.outputs = outputs;
    } else if (named.outputs.empty()) {
        outputs.resize(site.outputs.size());
        std::iota(outputs.begin(), outputs.end(), 0u);
    }
    for (const Named<SourceId>& source : named.sources)
        for (const std::size_t output : outputs) {
            if (isComposed(source.wish, look.outputs[output]))
                faults.add(source.at.error(fmt::format(
                    "the layers on '{}' are composed in order, so they move together; name the output without 'sources'",
                    site.outputs[output].name)));
            part.layers.push_back({output, source.wish});
        }
    for (const CuePart::Name& relay : named.relays)
        faults.take(indexOf(relay, namesOf(site.relays), "relay", site),
                    [&](std::size_t index) { part.relays.push_back(index); });
    for (const CuePart::Name& fixture : named.fixtures)
        faults.take(indexOf(fixture, namesOf(site.fixtures), "fixture", site), [&](std::size_t index) {
            for (std::size_t slot = 0; slot < site.fixtures[index].channels.size(); ++slot)
                part.levels.push_back(site.firstLevel(index) + slot);
        });
    return part;
}

// The parts of a cue, looked up. What is in two of them goes to `faults`.
std::vector<CueList::Part> boundParts(const Cue& cue, const Look& look, const Site& site, ConfigFaults& faults) {
    std::vector<CueList::Part> parts;
    std::set<std::pair<std::size_t, SourceId>> layers;
    std::set<std::size_t> outputs, levels, relays;
    for (const CuePart& named : cue.parts) {
        CueList::Part part = boundPart(named, cue, look, site, faults);
        bool twice = false;
        const auto take = [&](std::set<std::size_t>& taken, const std::vector<std::size_t>& things) {
            for (const std::size_t thing : things) twice = !taken.insert(thing).second || twice;
        };
        take(outputs, part.outputs);
        take(levels, part.levels);
        take(relays, part.relays);
        for (const auto& [output, source] : part.layers) twice = !layers.emplace(output, source).second || twice;
        if (twice) faults.add(named.at.error("this part names what it or another part of the cue names already"));
        parts.push_back(std::move(part));
    }
    return parts;
}

// Puts how a look's sources play over how they played in the cue before.
void putPlays(const NamedLook& named, CueList::Cue& cue) {
    cue.restarts.clear();
    for (const auto& [source, speed, restarts] : named.plays) {
        if (restarts) cue.restarts.push_back(source);
        if (!speed) continue;
        std::erase_if(cue.speeds, [&](const auto& before) { return before.source == source; });
        cue.speeds.push_back({source, *speed});
    }
}

// The sources of a look that come to an end.
std::vector<CueList::Cue::Ending> endingsOf(const Look& look, const PlayLengths& lengths) {
    std::set<SourceId> seen;
    for (const OutputState& output : look.outputs)
        for (const LayerState& layer : output.layers)
            if (layer.opacity > 0) seen.insert(layer.source);
    std::vector<CueList::Cue::Ending> endings;
    for (const SourceId source : seen)
        if (const Time* const length = lengths.find(source)) endings.push_back({source, *length});
    return endings;
}

// What a cue waits for before another one follows. A cue in which nothing comes to an end goes to
// `faults`.
void bindMedia(const Cue& cue, const PlayLengths* lengths, CueList::Cue& bound, ConfigFaults& faults) {
    if (lengths == nullptr) {
        bound.follow = *cue.follow + cue.length();
        return;
    }
    bound.endings = endingsOf(bound.look, *lengths);
    if (bound.endings.empty())
        faults.add(cue.mediaEnd->error(
            "nothing that is seen in this cue comes to an end; give its video 'times', or its shadow 'play: once'"));
}

// The cues of one list. Names that the site does not have go to `faults`.
std::vector<CueList::Cue> boundCues(const std::vector<Cue>& cues, const Show& show, const Site& site, const PlayLengths* lengths,
                                    ConfigFaults& faults) {
    CueList::Cue nothing;
    nothing.look = darkLook(site);
    nothing.winds.resize(site.outputs.size());
    std::vector<CueList::Cue> bound;
    for (const Cue& cue : cues) {
        const NamedLook& look = show.looks[cue.look];
        CueList::Cue& next = bound.emplace_back(cue.blocks || bound.empty() ? nothing : bound.back());
        putLook(look, site, next.look, faults);
        putWinds(look, site, next.winds);
        putPlays(look, next);
        next.tracksRelays.assign(site.relays.size(), cue.blocks ? 0 : 1);
        for (const auto& relay : look.relays)
            if (const auto index = findName(relay.name, namesOf(site.relays), "")) next.tracksRelays[*index] = 0;
        next.wait = cue.wait;
        next.fade = cue.fade;
        next.follow = cue.follow;
        next.endings.clear();
        if (cue.mediaEnd) bindMedia(cue, lengths, next, faults);
        next.followers = cue.followers;
        next.times = cue.times;
        next.name = cue.name;
        next.parts = boundParts(cue, next.look, site, faults);
        next.with = cue.with;
    }
    return bound;
}

// A side list keeps its hands off relays that none of its looks names: they track in all its cues.
void keepOff(const std::vector<Cue>& cues, const Show& show, const Site& site, CueList& side) {
    std::set<std::string> named;
    for (const Cue& cue : cues)
        for (const auto& relay : show.looks[cue.look].relays) named.insert(relay.name);
    for (CueList::Cue& cue : side.cues)
        for (std::size_t relay = 0; relay < site.relays.size(); ++relay)
            if (!named.contains(site.relays[relay].name)) cue.tracksRelays[relay] = 1;
}

// Whether a look of a list says what the wind of an output is.
bool hasWind(const std::vector<Cue>& cues, const Show& show, const Output& output) {
    return std::ranges::any_of(cues, [&](const Cue& cue) {
        const NamedLook& look = show.looks[cue.look];
        return look.wind || std::ranges::any_of(look.outputs, [&](const auto& named) {
                   return named.wish.wind && (named.name == output.name || named.name == output.canvas);
               });
    });
}

// The list that moves the wind of each output. What two lists would move goes to `faults`.
std::vector<std::size_t> boundWinds(const Show& show, const Site& site, ConfigFaults& faults) {
    std::vector<std::size_t> owners;
    for (const Output& output : site.outputs) {
        std::optional<std::size_t> owner;
        if (hasWind(show.cues, show, output)) owner = 0;
        for (std::size_t side = 0; side < show.sides.size(); ++side) {
            if (!hasWind(show.sides[side].cues, show, output)) continue;
            if (owner)
                faults.add(show.sides[side].at.error(
                    fmt::format("the wind on '{}' is moved by {} already; one list can move it", output.name,
                                *owner == 0 ? "the show's cues" : "'" + show.sides[*owner - 1].name + "'")));
            owner = side + 1;
        }
        owners.push_back(owner.value_or(0));
    }
    return owners;
}

}  // namespace

Result<CueList> bound(const Show& show, const Site& site, const PlayLengths* lengths) {
    CueList list;
    list.dark = darkLook(site);
    ConfigFaults faults;
    for (const NamedLook& look : show.looks) {  // all of them, so that each fault is told once
        Look ignored = list.dark;
        putLook(look, site, ignored, faults);
    }
    TRY(faults.result());
    for (std::size_t fixture = 0; fixture < site.fixtures.size(); ++fixture)
        list.fixtures.push_back({site.firstLevel(fixture), site.fixtures[fixture].channels.size()});
    list.windLists = boundWinds(show, site, faults);
    list.goInterval = show.goInterval;
    list.blackoutFade = show.blackoutFade;
    list.panicFade = show.panicFade;
    list.darkFade = show.schedule ? show.schedule->fade : show.blackoutFade;
    list.seed = show.seed;
    list.farthestShift = site.corrections.geometry.farthest;
    list.shiftSpeed = site.corrections.geometry.speed;
    list.exchangeFade = fromSeconds(site.corrections.pattern.fade);
    const Corrections::Lamps& lamps = site.corrections.lamps;
    list.trim = {static_cast<float>(lamps.least), lamps.speed, static_cast<int>(lamps.relays.size()), lamps.hold};
    for (const SideList& named : show.sides) {
        CueList side = list;
        side.sides.clear();
        side.name = named.name;
        side.start = named.start;
        side.loops = named.loops;
        side.seed = streamSeed(show.seed, {kSideStream, list.sides.size()});
        side.cues = boundCues(named.cues, show, site, lengths, faults);
        keepOff(named.cues, show, site, side);
        list.sides.push_back(std::make_shared<const CueList>(std::move(side)));
    }
    list.loops = show.loops;
    list.cues = boundCues(show.cues, show, site, lengths, faults);
    TRY(faults.result());
    return list;
}

}  // namespace fantascope::show
