#include "show/show.h"

#include "show/follow_loops.h"

#include "core/config/config.h"
#include "core/geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <span>
#include <utility>

namespace fantascope::show {

namespace {

constexpr std::int64_t kNewestVersion = kTrackingVersion;  // of the file

// Defaults. 0.3 s is shorter than a deliberate second press and longer than a bouncing or trembling
// one; as a fade it is quick without being a flash.
constexpr Time kGoInterval = std::chrono::milliseconds(300);
constexpr Time kBlackoutFade = std::chrono::milliseconds(300);
constexpr Time kPanicFade = std::chrono::seconds(2);

// Limits in seconds.
constexpr double kLongestGoInterval = 5;
constexpr double kLongestBlackoutFade = 10;
constexpr double kStrongestWind = 4;  // times what a pattern was made for

// How a show starts if it does not start with a cue: waiting for GO, or by its schedule.
constexpr std::string_view kStarts[] = {"dark", "schedule"};

template <class Range>
std::vector<std::string> namesOf(const Range& things) {
    std::vector<std::string> names;
    names.reserve(things.size());
    for (const auto& thing : things) names.push_back(thing.name);
    return names;
}

// The index of `name` among `known`. Error: "no output is called 'lefd' (did you mean 'left'?)".
Result<std::size_t> find(std::string_view name, const std::vector<std::string>& known, std::string_view what) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found != known.end()) return static_cast<std::size_t>(found - known.begin());
    const std::string nearest = nearestName(name, known);
    const std::string advice = !nearest.empty() ? fmt::format("did you mean '{}'?", nearest)
                               : known.empty()  ? std::string("there is none at all")
                                                : fmt::format("known: {}", fmt::join(known, ", "));
    return Error(fmt::format("no {} is called '{}' ({})", what, name, advice));
}

// The layers of one output of a look.
Result<OutputState> readLayers(const ConfigNode& node, const CueRules& rules) {
    OutputState output;
    for (const ConfigNode& item : TRY(node.items())) {
        LayerState layer;
        double opacity = 1;
        ConfigFields fields(item);
        std::size_t source = 0;
        fields.read("source", source, [&](const ConfigNode& value) { return value.choice(rules.sources); });
        fields.optional().number("opacity", opacity, 0, 1);
        fields.optional().choice("blend", layer.blend, {"add", "over", "multiply", "screen"});
        TRY(fields.finish());
        layer.source = rules.ids[source];
        layer.opacity = static_cast<float>(opacity);
        const auto same = [&](const LayerState& other) { return other.source == layer.source; };
        if (std::any_of(output.layers.begin(), output.layers.end(), same))
            return item.error(
                fmt::format("'{}' is on this output already; one layer of a source is enough", rules.sources[source]));
        output.layers.push_back(layer);
    }
    // Layers that only add their light need no order, so a fade can treat each source by itself.
    const auto adds = [](const LayerState& layer) { return layer.blend == Blend::Add; };
    if (!std::all_of(output.layers.begin(), output.layers.end(), adds))
        output.pictures.push_back({0, static_cast<std::uint32_t>(output.layers.size()), 1.0f});
    return output;
}

Result<WindWish> readWind(const ConfigNode& node) {
    WindWish wind;
    ConfigFields fields(node);
    fields.optional().number("strength", wind.strength, 0, kStrongestWind);
    fields.optional().number("gusts", wind.gusts, 0, 1);
    fields.optional().read("direction", wind.direction, [](const ConfigNode& value) -> Result<std::optional<double>> {
        return std::optional(radians(TRY(value.number(-360, 360, "degrees"))));
    });
    TRY(fields.finish());
    return wind;
}

// An output of a look: its layers, or a map with them and a wind of its own.
Result<NamedLook::OutputWish> readOutput(const ConfigNode& node, const CueRules& rules) {
    NamedLook::OutputWish output;
    if (!node.isMap()) {
        output.layers = TRY(readLayers(node, rules));
        return output;
    }
    ConfigFields fields(node);
    fields.read("layers", output.layers, [&](const ConfigNode& layers) { return readLayers(layers, rules); });
    fields.optional().read("wind", output.wind, [](const ConfigNode& wind) -> Result<std::optional<WindWish>> {
        return std::optional(TRY(readWind(wind)));
    });
    TRY(fields.finish());
    return output;
}

Result<float> readLevel(const ConfigNode& node) { return static_cast<float>(TRY(node.number(0, 1))); }

Result<bool> readSwitch(const ConfigNode& node) { return TRY(node.choice({"off", "on"})) == 1; }

// A map whose keys are names of the site.
template <class Wish, class Read>
Result<std::vector<Named<Wish>>> readNamed(const ConfigNode& node, Read read) {
    std::vector<Named<Wish>> wishes;
    ConfigFaults faults;
    for (const auto& [name, value] : TRY(node.entries()))
        faults.take(Result<Wish>(read(value)), [&](Wish wish) { wishes.push_back({name, value.here(), std::move(wish)}); });
    TRY(faults.result());
    return wishes;
}

Result<NamedLook::Levels> readLevels(const ConfigNode& node) {
    if (node.isMap()) return NamedLook::Levels(TRY(readNamed<float>(node, readLevel)));
    return NamedLook::Levels(TRY(readLevel(node)));
}

Result<NamedLook> readLook(const std::string& name, const ConfigNode& node, const CueRules& rules) {
    NamedLook look;
    look.name = name;
    ConfigFields fields(node);
    fields.optional().read("outputs", look.outputs, [&](const ConfigNode& map) {
        return readNamed<NamedLook::OutputWish>(map, [&](const ConfigNode& output) { return readOutput(output, rules); });
    });
    fields.optional().read("fixtures", look.fixtures,
                           [](const ConfigNode& map) { return readNamed<NamedLook::Levels>(map, readLevels); });
    fields.optional().read("wind", look.wind, [](const ConfigNode& wind) -> Result<std::optional<WindWish>> {
        return std::optional(TRY(readWind(wind)));
    });
    fields.optional().read("relays", look.relays, [](const ConfigNode& map) { return readNamed<bool>(map, readSwitch); });
    TRY(fields.finish());
    return look;
}

// How a show starts: with a cue, as index into `cues`, or one of kStarts, after these.
Result<std::size_t> readStart(const ConfigNode& node, const std::vector<Cue>& cues) {
    std::vector<std::string> names = namesOf(cues);
    for (const std::string_view start : kStarts) {
        if (std::ranges::find(names, start) != names.end() && TRY(node.text()) == start)
            return node.error(fmt::format("'{}' is no cue here, but a cue is called so, too; rename the cue", start));
        names.emplace_back(start);
    }
    return node.choice(names);
}

// `start`: what readStart() gave. Error: it is the schedule and there is none, or the other way
// round.
Result<void> startAs(std::size_t start, const ConfigNode& root, Show& show) {
    if (start < show.cues.size()) show.start = start;
    const bool isBySchedule = start == show.cues.size() + 1;
    if (isBySchedule && !show.schedule) return root.error("'start: schedule' needs the key 'schedule', with the nights");
    if (!isBySchedule && show.schedule)
        return show.schedule->at.error("this show does not play by its schedule; add 'start: schedule'");
    return {};
}

// The index in the site of a thing that the show calls by name.
template <class Wish>
Result<std::size_t> indexOf(const Named<Wish>& wanted, const std::vector<std::string>& known, std::string_view what,
                            const Site& site) {
    const auto index = find(wanted.name, known, what);
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

}  // namespace

Result<Show> Show::load(const std::filesystem::path& fileOrFolder) {
    SourceNames names;
    return load(fileOrFolder, names);
}

Result<Show> Show::load(const std::filesystem::path& fileOrFolder, SourceNames& names) {
    Show show;
    std::error_code ignored;
    show.file = std::filesystem::is_directory(fileOrFolder, ignored) ? fileOrFolder / "show.yaml" : fileOrFolder;
    show.goInterval = kGoInterval;
    show.blackoutFade = kBlackoutFade;
    show.panicFade = kPanicFade;
    const ConfigNode root = TRY(ConfigNode::load(show.file));
    ConfigFields fields(root);
    // Faulty sources and looks are among the known ones. They are reported once, and not again
    // where they are named.
    CueRules rules{.version = fields.header("show", kNewestVersion), .looks = {}, .sources = {}, .ids = {}};
    fields.text("title", show.title);
    fields.optional().time("go_interval", show.goInterval, 0, kLongestGoInterval);
    fields.optional().time("blackout_fade", show.blackoutFade, 0, kLongestBlackoutFade);
    fields.optional().integer("seed", show.seed, 0, std::numeric_limits<std::int64_t>::max());
    fields.read("sources", show.sources, [&](const ConfigNode& node) -> Result<std::vector<Source>> {
        std::vector<Source> sources;
        ConfigFaults faults;
        for (const auto& [name, source] : TRY(node.entries())) {
            rules.sources.push_back(name);
            rules.ids.push_back(names.idOf(name));
            faults.take(readSource(name, rules.ids.back(), source), [&](Source read) { sources.push_back(std::move(read)); });
        }
        TRY(faults.result());
        return sources;
    });
    fields.read("looks", show.looks, [&](const ConfigNode& node) -> Result<std::vector<NamedLook>> {
        std::vector<NamedLook> looks;
        ConfigFaults faults;
        for (const auto& [name, look] : TRY(node.entries())) {
            rules.looks.push_back(name);
            faults.take(readLook(name, look, rules), [&](NamedLook read) { looks.push_back(std::move(read)); });
        }
        TRY(faults.result());
        return looks;
    });
    readTracking(rules.version, fields, "panic_fade", show.panicFade, [](const ConfigNode& node) -> Result<Time> {
        return fromSeconds(TRY(node.number(0, kLongestBlackoutFade, "s")));
    });
    readTracking(rules.version, fields, "at_end", rules.loops, [](const ConfigNode& node) -> Result<bool> {
        return TRY(node.choice({"stay", "loop"})) == 1;
    });
    show.loops = rules.loops;
    fields.read("cues", show.cues, [&](const ConfigNode& node) { return readCues(node, rules); });
    std::size_t start = show.cues.size();  // dark
    readTracking(rules.version, fields, "start", start, [&](const ConfigNode& node) {
        return show.cues.empty() ? Result(start) : readStart(node, show.cues);  // faulty cues are told already
    });
    readTracking(rules.version, fields, "schedule", show.schedule,
                 [&](const ConfigNode& node) -> Result<std::optional<Schedule>> {
                     if (show.cues.empty()) return std::optional<Schedule>();
                     return std::optional(TRY(readSchedule(node, namesOf(show.cues))));
                 });
    TRY(fields.finish());
    TRY(startAs(start, root, show));
    return show;
}

Result<CueList> Show::bind(const Site& site) const {
    CueList list;
    list.dark = darkLook(site);
    ConfigFaults faults;
    for (const NamedLook& look : looks) {  // all of them, so that each fault is told once
        Look bound = list.dark;
        putLook(look, site, bound, faults);
    }
    TRY(faults.result());

    CueList::Cue nothing;
    nothing.look = list.dark;
    nothing.winds.resize(site.outputs.size());
    for (const Cue& cue : cues) {
        CueList::Cue bound = cue.blocks || list.cues.empty() ? nothing : list.cues.back();
        putLook(looks[cue.look], site, bound.look, faults);
        putWinds(looks[cue.look], site, bound.winds);
        bound.wait = cue.wait;
        bound.fade = cue.fade;
        bound.follow = cue.follow;
        bound.followers = cue.followers;
        bound.times = cue.times;
        bound.name = cue.name;
        bound.parts = boundParts(cue, bound.look, site, faults);
        list.cues.push_back(std::move(bound));
    }
    TRY(faults.result());
    list.loops = loops;
    list.goInterval = goInterval;
    list.blackoutFade = blackoutFade;
    list.panicFade = panicFade;
    list.darkFade = schedule ? schedule->fade : blackoutFade;
    list.seed = seed;
    list.farthestShift = site.corrections.geometry.farthest;
    list.shiftSpeed = site.corrections.geometry.speed;
    list.exchangeFade = fromSeconds(site.corrections.pattern.fade);
    const Corrections::Lamps& lamps = site.corrections.lamps;
    list.trim = {static_cast<float>(lamps.least), lamps.speed, static_cast<int>(lamps.relays.size()), lamps.hold};
    return list;
}

bool Show::needsNoGoFrom(std::size_t cue) const {
    std::set<std::size_t> reached{cue};
    for (std::vector<std::size_t> waiting{cue}; !waiting.empty();) {
        const std::size_t now = waiting.back();
        waiting.pop_back();
        if (!cues[now].follow && (loops || now + 1 < cues.size())) return false;
        for (const std::size_t follower : followersOf(cues, now, loops))
            if (reached.insert(follower).second) waiting.push_back(follower);
    }
    return true;
}

std::string Show::beginning() const {
    if (schedule) return "plays by its schedule";
    if (!start) return "starts dark and waits for GO";
    return fmt::format("starts with '{}' and {}", cues[*start].name,
                       !needsNoGoFrom(*start) ? "waits for GO later"
                       : loops                ? "plays by itself for ever"
                                              : "plays by itself to its end");
}

Result<std::size_t> Show::cueNamed(std::string_view nameOrNumber) const {
    const auto named = find(nameOrNumber, namesOf(cues), "cue").in(file.string());
    const auto numbered = std::ranges::find(cues, nameOrNumber, [](const Cue& cue) { return textOf(cue.number); });
    return named || numbered == cues.end() ? named : static_cast<std::size_t>(numbered - cues.begin());
}

}  // namespace fantascope::show
