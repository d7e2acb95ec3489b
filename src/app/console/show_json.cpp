#include "app/console/show_json.h"

#include "show/names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <span>
#include <variant>

namespace fantascope::app {

namespace {

// What a look does, in words: "left: leaves, moon. gate 80 %. fog on".
std::string wordsOf(const show::NamedLook& look, const show::Show& show) {
    std::vector<std::string> sentences;
    for (const auto& output : look.outputs) {
        std::set<std::string> names;
        for (const show::LayerState& layer : output.wish.layers.layers) {
            const auto source = std::ranges::find(show.sources, layer.source, &show::Source::id);
            if (source != show.sources.end()) names.insert(source->name);
        }
        sentences.push_back(
            fmt::format("{}: {}", output.name, names.empty() ? "dark" : fmt::format("{}", fmt::join(names, ", "))));
    }
    std::vector<std::string> lamps;
    for (const auto& fixture : look.fixtures) {
        const float* const level = std::get_if<float>(&fixture.wish);
        lamps.push_back(level != nullptr ? fmt::format("{} {:.0f} %", fixture.name, 100 * *level) : fixture.name);
    }
    for (const auto& relay : look.relays) lamps.push_back(fmt::format("{} {}", relay.name, relay.wish ? "on" : "off"));
    if (!lamps.empty()) sentences.push_back(fmt::format("{}", fmt::join(lamps, ", ")));
    return fmt::format("{}", fmt::join(sentences, ". "));
}

Report cueJson(const std::vector<show::Cue>& cues, int index, const show::Show& show) {
    const show::Cue& cue = cues[static_cast<std::size_t>(index)];
    Report json;
    json["index"] = index;
    json["number"] = show::textOf(cue.number);
    json["name"] = cue.name;
    json["note"] = cue.note;
    json["does"] = wordsOf(show.looks[cue.look], show);
    return json;
}

// A cue of a list, or null.
Report cueOrNull(const std::vector<show::Cue>& cues, std::optional<int> index, const show::Show& show) {
    return index && *index >= 0 ? cueJson(cues, *index, show) : Report();
}

// A moment to come, by cue time; null if it has come.
Report momentJson(Time now, std::optional<Time> left) { return left && *left > Time{} ? Report(seconds(now + *left)) : Report(); }

Report listJson(const show::ShowState& state, const show::Playback& playback, const show::Show& show, int list) {
    const std::vector<show::Cue>& cues = show.cuesOf(list);
    const show::ListPlace place =
        list == 0 ? show::ListPlace{state.cue, state.loaded, state.next} : state.sides[static_cast<std::size_t>(list) - 1];
    const Time now = playback.cueTimeAt(state.time);
    Report json;
    json["name"] = list == 0 ? std::string() : show.sides[static_cast<std::size_t>(list) - 1].name;
    json["cues"] = cues.size();
    json["cue"] = cueOrNull(cues, place.cue, show);
    json["go"] = cueOrNull(cues, place.next, show);
    json["loaded"] = place.loaded >= 0;
    json["waits_until"] = momentJson(now, playback.waitLeftAt(state.time, list));
    json["fades_until"] = momentJson(now, playback.fadeLeftAt(state.time, list));
    const auto follower = playback.followerAt(state.time, list);
    json["follower"] = cueOrNull(cues, follower, show);
    json["follows_at"] = follower ? momentJson(now, playback.untilFollowAt(state.time, list)) : Report();
    return json;
}

}  // namespace

Report cuesJson(const show::Revision& revision) {
    Report lists = Report::array();
    for (int list = 0; list <= static_cast<int>(revision.show.sides.size()); ++list) {
        Report json;
        json["name"] = list == 0 ? std::string() : revision.show.sides[static_cast<std::size_t>(list) - 1].name;
        json["cues"] = Report::array();
        const std::vector<show::Cue>& cues = revision.show.cuesOf(list);
        for (int cue = 0; cue < static_cast<int>(cues.size()); ++cue) json["cues"].push_back(cueJson(cues, cue, revision.show));
        lists.push_back(std::move(json));
    }
    return Report{{"show", revision.show.title}, {"lists", std::move(lists)}};
}

Report stateJson(const show::ShowState& state, const show::Playback& playback, const show::Revision& revision) {
    const show::Site& site = revision.site;
    Report json;
    json["show"] = revision.show.title;
    json["revision"] = state.revision;
    json["inputs"] = state.inputs;
    json["lists"] = Report::array();
    for (int list = 0; list <= static_cast<int>(state.sides.size()); ++list)
        json["lists"].push_back(listJson(state, playback, revision.show, list));
    for (const auto& hold : show::kHolds) json["holds"][std::string(hold.name)] = state.*hold.on;
    json["master"] = state.master;
    json["corrections"] = state.corrects;
    const auto lamp = [&](int fixture) { return Report(site.fixtures[static_cast<std::size_t>(fixture)].name); };
    json["highlight"] = Report();
    if (state.highlight >= 0)
        json["highlight"] = {{"lamp", lamp(state.highlight)}, {"level", state.highlightLevel}, {"solo", state.solo}};
    json["parked"] = Report::array();
    for (const int fixture : state.parked) json["parked"].push_back(lamp(fixture));
    json["raised"] = Report::array();
    for (const auto& [fixture, level] : state.raised) json["raised"].push_back({{"lamp", lamp(fixture)}, {"level", level}});
    json["switched"] = Report::array();
    for (const auto& [relay, on] : state.switched)
        json["switched"].push_back({{"relay", site.relays[static_cast<std::size_t>(relay)].name}, {"on", on}});
    return json;
}

Report lightsJson(const show::ShowState& state, const show::Revision& revision) {
    Report lamps = Report::array(), relays = Report::array();
    for (std::size_t i = 0; i < revision.site.fixtures.size(); ++i) {
        const auto [first, count] = revision.cues.fixtures[i];
        const auto raised = std::ranges::find(state.raised, static_cast<int>(i), &show::RaisedLamp::fixture);
        Report levels = Report::array();
        for (const float level : std::span(state.levels).subspan(first, count)) levels.push_back(level);
        lamps.push_back({{"name", revision.site.fixtures[i].name},
                         {"levels", std::move(levels)},
                         {"raised", raised == state.raised.end() ? 0.0f : raised->level}});
    }
    for (std::size_t i = 0; i < revision.site.relays.size(); ++i) {
        const auto switched = std::ranges::find(state.switched, static_cast<int>(i), &show::SwitchedRelay::relay);
        relays.push_back({{"name", revision.site.relays[i].name},
                          {"on", state.relays[i] != 0},
                          {"by_hand", switched != state.switched.end()}});
    }
    return {{"lamps", std::move(lamps)}, {"relays", std::move(relays)}};
}

Report clockJson(const show::ShowState& state, const show::Playback& playback) {
    return {{"show", seconds(state.time)},
            {"cue", seconds(playback.cueTimeAt(state.time))},
            {"moves", !state.paused && !state.panic}};
}

}  // namespace fantascope::app
