#include "show/show.h"

#include "show/binding.h"
#include "show/follow_loops.h"
#include "show/names.h"

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
const std::vector<std::string> kStarts = {"dark", "schedule"};

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

// How a look's sources play, by their names: a speed, or a map.
Result<std::vector<NamedLook::Play>> readPlays(const ConfigNode& node, const CueRules& rules) {
    constexpr double kHighestSpeed = 10;
    std::vector<NamedLook::Play> plays;
    ConfigFaults faults;
    const auto speedOf = [](const ConfigNode& value) -> Result<std::optional<float>> {
        return std::optional(static_cast<float>(TRY(value.number(0, kHighestSpeed))));
    };
    const auto readPlay = [&](const std::string& name, const ConfigNode& value) -> Result<NamedLook::Play> {
        const auto source = findName(name, rules.sources, "source");
        if (!source) return value.error(source.error().message());
        NamedLook::Play play{.source = rules.ids[*source], .speed = {}};
        if (!value.isMap()) {
            play.speed = TRY(speedOf(value));
            return play;
        }
        ConfigFields fields(value);
        fields.optional().read("speed", play.speed, speedOf);
        fields.optional().boolean("restart", play.restarts);
        TRY(fields.finish());
        return play;
    };
    for (const auto& [name, value] : TRY(node.entries()))
        faults.take(readPlay(name, value), [&](NamedLook::Play play) { plays.push_back(play); });
    TRY(faults.result());
    return plays;
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
    readTracking(rules.version, fields, "play", look.plays, [&](const ConfigNode& map) { return readPlays(map, rules); });
    TRY(fields.finish());
    return look;
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
    CueRules rules{.version = fields.header("show", kNewestVersion), .looks = {}, .sources = {}, .ids = {}, .sides = {}};
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
    readTracking(rules.version, fields, "at_end", rules.loops, readAtEnd);
    show.loops = rules.loops;
    readTracking(rules.version, fields, "lists", show.sides, [&](const ConfigNode& node) { return readSides(node, rules); });
    fields.read("cues", show.cues, [&](const ConfigNode& node) { return readCues(node, rules); });
    std::size_t start = show.cues.size();  // dark
    readTracking(rules.version, fields, "start", start, [&](const ConfigNode& node) {
        return show.cues.empty() ? Result(start) : readStart(node, show.cues, kStarts);  // faulty cues are told already
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

Result<CueList> Show::bind(const Site& site, const PlayLengths* lengths) const { return bound(*this, site, lengths); }

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
    const auto named = findName(nameOrNumber, namesOf(cues), "cue").in(file.string());
    const auto numbered = std::ranges::find(cues, nameOrNumber, [](const Cue& cue) { return textOf(cue.number); });
    return named || numbered == cues.end() ? named : static_cast<std::size_t>(numbered - cues.begin());
}

}  // namespace fantascope::show
