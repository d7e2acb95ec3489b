#include "show/show.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fantascope::show {

namespace {

constexpr int kNewestVersion = 1;

// Defaults. 0.3 s is shorter than a deliberate second press and longer than a bouncing or trembling one; as a fade it is quick
// without being a flash.
constexpr Time kGoInterval = std::chrono::milliseconds(300);
constexpr Time kBlackoutFade = std::chrono::milliseconds(300);

// Limits in seconds.
constexpr double kLongestGoInterval = 5;
constexpr double kLongestBlackoutFade = 10;
constexpr double kLongestFade = 3600;
constexpr double kLongestFollow = 86400;

template <class Range>
std::vector<std::string> namesOf(const Range& things) {
    std::vector<std::string> names;
    names.reserve(things.size());
    for (const auto& thing : things) names.push_back(thing.name);
    return names;
}

// The index of `name` among `known`, or why not: "left: no output is called 'lefd' (did you mean 'left'?)".
Result<std::size_t> find(std::string_view name, const std::vector<std::string>& known, std::string_view what) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found != known.end()) return static_cast<std::size_t>(found - known.begin());
    const std::string nearest = nearestName(name, known);
    const std::string advice = !nearest.empty() ? fmt::format("did you mean '{}'?", nearest)
                               : known.empty()  ? std::string("there is none at all")
                                                : fmt::format("known: {}", fmt::join(known, ", "));
    return Error(fmt::format("no {} is called '{}' ({})", what, name, advice));
}

Result<PatternSource> readPatternSource(const ConfigNode& node) {
    const std::filesystem::path file = TRY(node.path());
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored))
        return node.error(fmt::format("there is no file {0}; make it with 'fantascope pattern GUIDE -o {0}'", file.string()));
    return PatternSource{file};
}

Result<Source> readSource(const std::string& name, const ConfigNode& node) {
    std::optional<PatternSource> pattern;
    std::optional<SolidSource> solid;
    ConfigFields fields(node);
    fields.optional().read("pattern", pattern, readPatternSource);
    fields.optional().read("solid", solid, [](const ConfigNode& colour) -> Result<SolidSource> {
        return SolidSource{glm::vec3(TRY(colour.vector3(0, 1)))};
    });
    TRY(fields.finish());
    if (pattern.has_value() == solid.has_value()) return node.error("exactly one kind of source is needed: 'pattern' or 'solid'");
    if (pattern) return Source{name, *pattern};
    return Source{name, *solid};
}

// The layers of one output of a look.
Result<OutputState> readLayers(const ConfigNode& node, const std::vector<std::string>& sources) {
    OutputState output;
    for (const ConfigNode& item : TRY(node.items())) {
        LayerState layer;
        double opacity = 1;
        ConfigFields fields(item);
        fields.read("source", layer.source, [&](const ConfigNode& value) -> Result<std::uint32_t> {
            return static_cast<std::uint32_t>(TRY(value.choice(sources)));
        });
        fields.optional().number("opacity", opacity, 0, 1);
        TRY(fields.finish());
        layer.opacity = static_cast<float>(opacity);
        const auto same = [&](const LayerState& other) { return other.source == layer.source; };
        if (std::any_of(output.layers.begin(), output.layers.end(), same))
            return item.error(
                fmt::format("'{}' is on this output already; one layer of a source is enough", sources[layer.source]));
        output.layers.push_back(layer);
    }
    return output;
}

Result<float> readLevel(const ConfigNode& node) { return static_cast<float>(TRY(node.number(0, 1))); }

Result<bool> readSwitch(const ConfigNode& node) { return TRY(node.choice({"off", "on"})) == 1; }

// A map whose keys are names of the site.
template <class Wish, class Read>
Result<std::vector<Named<Wish>>> readNamed(const ConfigNode& node, Read read) {
    std::vector<Named<Wish>> wishes;
    for (const auto& [name, value] : TRY(node.entries())) {
        Wish wish = TRY(read(value));
        wishes.push_back({name, value, std::move(wish)});
    }
    return wishes;
}

Result<std::variant<float, NamedLook::ChannelLevels>> readLevels(const ConfigNode& node) {
    if (!node.isMap()) return std::variant<float, NamedLook::ChannelLevels>(TRY(readLevel(node)));
    return std::variant<float, NamedLook::ChannelLevels>(TRY(readNamed<float>(node, readLevel)));
}

Result<NamedLook> readLook(const std::string& name, const ConfigNode& node, const std::vector<std::string>& sources) {
    NamedLook look;
    look.name = name;
    ConfigFields fields(node);
    fields.optional().read("outputs", look.outputs, [&](const ConfigNode& map) {
        return readNamed<OutputState>(map, [&](const ConfigNode& layers) { return readLayers(layers, sources); });
    });
    fields.optional().read("fixtures", look.fixtures, [](const ConfigNode& map) {
        return readNamed<std::variant<float, NamedLook::ChannelLevels>>(map, readLevels);
    });
    fields.optional().read("relays", look.relays, [](const ConfigNode& map) { return readNamed<bool>(map, readSwitch); });
    TRY(fields.finish());
    return look;
}

Result<Cue> readCue(const ConfigNode& node, const std::vector<std::string>& looks) {
    Cue cue;
    ConfigFields fields(node);
    fields.text("name", cue.name);
    fields.read("look", cue.look, [&](const ConfigNode& value) { return value.choice(looks); });
    fields.time("fade", cue.fade, 0, kLongestFade);
    fields.optional().read("follow", cue.follow, [](const ConfigNode& value) -> Result<Time> {
        return fromSeconds(TRY(value.number(0, kLongestFollow, "s")));
    });
    TRY(fields.finish());
    return cue;
}

Result<std::vector<Cue>> readCues(const ConfigNode& node, const std::vector<std::string>& looks) {
    std::vector<Cue> cues;
    const auto items = TRY(node.items(1));
    for (const ConfigNode& item : items) {
        Cue cue = TRY(readCue(item, looks));
        const auto same = [&](const Cue& other) { return other.name == cue.name; };
        if (std::any_of(cues.begin(), cues.end(), same))
            return item.error(fmt::format("another cue is called '{}'; each needs its own name", cue.name));
        cues.push_back(std::move(cue));
    }
    if (cues.back().follow) return items.back().error("no cue comes after this one; take its 'follow' away");
    return cues;
}

// Where each fixture's first channel stands in Look::levels.
std::vector<std::size_t> firstLevels(const Site& site) {
    std::vector<std::size_t> first;
    std::size_t next = 0;
    for (const Fixture& fixture : site.fixtures) {
        first.push_back(next);
        next += fixture.channels.size();
    }
    return first;
}

// The names of a site, to look up those of a show in.
class SiteNames {
public:
    explicit SiteNames(const Site& site)
        : site_(site),
          outputs_(namesOf(site.outputs)),
          fixtures_(namesOf(site.fixtures)),
          relays_(namesOf(site.relays)),
          firstLevels_(firstLevels(site)) {}

    Look dark() const {
        Look look;
        look.outputs.resize(site_.outputs.size());
        look.levels.assign(site_.channelCount(), 0.0f);
        for (const Relay& relay : site_.relays) look.relays.push_back(relay.safe);
        return look;
    }

    Result<Look> bind(const NamedLook& named) const {
        Look look = dark();
        for (const auto& output : named.outputs) look.outputs[TRY(indexOf(output, outputs_, "output"))] = output.wish;
        for (const auto& relay : named.relays) look.relays[TRY(indexOf(relay, relays_, "relay"))] = relay.wish;
        for (const auto& wanted : named.fixtures) {
            const std::size_t index = TRY(indexOf(wanted, fixtures_, "fixture"));
            const std::vector<std::string>& channels = site_.fixtures[index].channels;
            const auto levels = look.levels.begin() + static_cast<std::ptrdiff_t>(firstLevels_[index]);
            if (const float* level = std::get_if<float>(&wanted.wish)) {
                std::fill_n(levels, channels.size(), *level);
            } else {
                for (const Named<float>& channel : std::get<NamedLook::ChannelLevels>(wanted.wish))
                    levels[static_cast<std::ptrdiff_t>(
                        TRY(indexOf(channel, channels, fmt::format("channel of '{}'", wanted.name))))] = channel.wish;
            }
        }
        return look;
    }

private:
    template <class Wish>
    Result<std::size_t> indexOf(const Named<Wish>& wanted, const std::vector<std::string>& known, std::string_view what) const {
        const auto index = find(wanted.name, known, what);
        if (!index) return wanted.at.error(fmt::format("{} in {}", index.error().message(), site_.file.string()));
        return *index;
    }

    const Site& site_;
    std::vector<std::string> outputs_, fixtures_, relays_;
    std::vector<std::size_t> firstLevels_;
};

}  // namespace

Result<Show> Show::load(const std::filesystem::path& fileOrFolder) {
    Show show;
    std::error_code ignored;
    show.file = std::filesystem::is_directory(fileOrFolder, ignored) ? fileOrFolder / "show.yaml" : fileOrFolder;
    show.goInterval = kGoInterval;
    show.blackoutFade = kBlackoutFade;
    const ConfigNode root = TRY(ConfigNode::load(show.file));
    ConfigFields fields(root);
    fields.header("show", kNewestVersion);
    fields.text("title", show.title);
    fields.optional().time("go_interval", show.goInterval, 0, kLongestGoInterval);
    fields.optional().time("blackout_fade", show.blackoutFade, 0, kLongestBlackoutFade);
    fields.read("sources", show.sources, [](const ConfigNode& node) -> Result<std::vector<Source>> {
        std::vector<Source> sources;
        for (const auto& [name, source] : TRY(node.entries())) sources.push_back(TRY(readSource(name, source)));
        return sources;
    });
    fields.read("looks", show.looks, [&](const ConfigNode& node) -> Result<std::vector<NamedLook>> {
        std::vector<NamedLook> looks;
        for (const auto& [name, look] : TRY(node.entries())) looks.push_back(TRY(readLook(name, look, namesOf(show.sources))));
        return looks;
    });
    fields.read("cues", show.cues, [&](const ConfigNode& node) { return readCues(node, namesOf(show.looks)); });
    TRY(fields.finish());
    return show;
}

Result<CueList> Show::bind(const Site& site) const {
    const SiteNames names(site);
    std::vector<Look> bound;
    for (const NamedLook& look : looks) bound.push_back(TRY(names.bind(look)));

    CueList list;
    for (const Cue& cue : cues) list.cues.push_back({bound[cue.look], cue.fade, cue.follow});
    list.dark = names.dark();
    list.goInterval = goInterval;
    list.blackoutFade = blackoutFade;
    return list;
}

Result<std::size_t> Show::cueNamed(std::string_view name) const { return find(name, namesOf(cues), "cue").in(file.string()); }

}  // namespace fantascope::show
