#include "show/cue.h"

#include "show/follow_loops.h"
#include "show/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::show {

namespace {

// Limits in seconds.
constexpr double kLongestFade = 3600;
constexpr double kLongestWait = 86400;
constexpr CueNumber kThousandths = 1000;
constexpr double kHighestNumber = 99999;

const std::initializer_list<std::string_view> kCurves = {"linear", "smooth", "slow_start", "slow_end"};

Result<Time> readTime(const ConfigNode& node, double longest) { return fromSeconds(TRY(node.number(0, longest, "s"))); }

Result<Fade> readFade(const ConfigNode& node, std::int64_t version) {
    if (!node.isMap()) return Fade(TRY(readTime(node, kLongestFade)));
    TRY(needsTracking(node, "in", version));
    Fade fade;
    ConfigFields fields(node);
    fields.time("in", fade.in, 0, kLongestFade);
    fields.time("out", fade.out, 0, kLongestFade);
    fields.optional().choice("curve", fade.curve, kCurves);
    TRY(fields.finish());
    return fade;
}

constexpr int kMostTimes = 10000;
constexpr std::string_view kDark = "dark";  // before the first cue of a list

// How a cue is followed by another one.
struct Follow {
    Time time{};
    // From when `time` counts: from when the cue is entered, from when its look is whole, or from
    // when all that plays has ended, too.
    enum class From { Entry, Fade, Media } from = From::Entry;
    FilePlace at{};              // of the key
    std::vector<ConfigNode> to;  // names of cues
    int times = 0;
};
Result<Follow> readFollow(const ConfigNode& node, std::int64_t version) {
    if (!node.isMap()) return Follow{.time = TRY(readTime(node, kLongestWait)), .to = {}};
    TRY(needsTracking(node, "follow", version));
    Follow follow;
    int given = 0;
    const auto waitFrom = [&](Follow::From from) {
        return [&, from](const ConfigNode& value) -> Result<Time> {
            ++given;
            follow.from = from;
            follow.at = value.here();
            return readTime(value, kLongestWait);
        };
    };
    ConfigFields fields(node);
    fields.optional().read("after", follow.time, waitFrom(Follow::From::Entry));
    fields.optional().read("after_fade", follow.time, waitFrom(Follow::From::Fade));
    fields.optional().read("after_media", follow.time, waitFrom(Follow::From::Media));
    fields.optional().read("to", follow.to, [](const ConfigNode& value) -> Result<std::vector<ConfigNode>> {
        return value.isList() ? TRY(value.items(1)) : std::vector{value};
    });
    fields.optional().integer("times", follow.times, 1, kMostTimes);
    TRY(fields.finish());
    if (given != 1) return node.error("give one of 'after', 'after_fade' and 'after_media', in seconds");
    if (follow.times > 0 && follow.to.empty()) return node.error("'times' counts how often 'to' follows; add 'to', or remove it");
    return follow;
}

Result<CueNumber> readNumber(const ConfigNode& node) {
    const double number = TRY(node.number(0, kHighestNumber)) * kThousandths;
    if (std::abs(number - std::round(number)) > 1e-6 || std::round(number) == 0)
        return node.error("a cue's number is above 0 and has at most three decimal places");
    return static_cast<CueNumber>(std::llround(number));
}

Result<CuePart::Name> readName(const ConfigNode& node) { return CuePart::Name{TRY(node.text()), node.here(), {}}; }

Result<CuePart> readPart(const ConfigNode& node, const CueRules& rules) {
    CuePart part{.at = node.here(), .wait = {}, .fade = {}, .outputs = {}, .fixtures = {}, .relays = {}, .sources = {}};
    ConfigFields fields(node);
    fields.optional().list("outputs", part.outputs, readName, 1);
    fields.optional().list(
        "sources", part.sources,
        [&](const ConfigNode& item) -> Result<Named<SourceId>> {
            const std::size_t source = TRY(item.choice(rules.sources));
            return Named<SourceId>{rules.sources[source], item.here(), rules.ids[source]};
        },
        1);
    fields.optional().list("fixtures", part.fixtures, readName, 1);
    fields.optional().list("relays", part.relays, readName, 1);
    fields.optional().read("wait", part.wait, [](const ConfigNode& value) { return readTime(value, kLongestWait); });
    fields.optional().read("fade", part.fade, [&](const ConfigNode& value) { return readFade(value, rules.version); });
    TRY(fields.finish());
    if (part.outputs.empty() && part.sources.empty() && part.fixtures.empty() && part.relays.empty())
        return node.error("this part names nothing; add 'outputs', 'sources', 'fixtures' or 'relays'");
    if (!part.wait && !part.fade) return node.error("this part moves as the rest of its cue does; add a 'wait' or a 'fade'");
    return part;
}

// Cues of the side lists, by the names of the lists.
Result<std::vector<CueList::Cue::SideCue>> readWith(const ConfigNode& node, const CueRules& rules) {
    std::vector<std::string> lists;
    for (const CueRules::Side& side : rules.sides) lists.push_back(side.name);
    if (lists.empty()) return node.error("no list plays beside this one; lists stand under 'lists' of the show");
    std::vector<CueList::Cue::SideCue> with;
    ConfigFaults faults;
    for (const auto& [name, cue] : TRY(node.entries())) {
        const auto list = findName(name, lists, "list");
        if (!list) {
            faults.add(cue.error(list.error().message()));
            continue;
        }
        std::vector<std::string> cues = rules.sides[*list].cues;
        if (cues.empty()) continue;  // told already
        const int dark = static_cast<int>(cues.size());
        if (std::ranges::find(cues, kDark) == cues.end()) cues.emplace_back(kDark);
        faults.take(cue.choice(cues), [&](std::size_t index) {
            with.push_back({*list, static_cast<int>(index) == dark ? -1 : static_cast<int>(index)});
        });
    }
    TRY(faults.result());
    return with;
}

// `to`: receives the names of the cues that are to follow it.
Result<Cue> readCue(const ConfigNode& node, const CueRules& rules, std::vector<ConfigNode>& to) {
    Cue cue;
    cue.blocks = rules.version < kTrackingVersion;
    std::optional<Follow> follow;
    ConfigFields fields(node);
    const auto since2 = [&](std::string_view key, auto& target, auto parse) {
        readTracking(rules.version, fields, key, target, parse);
    };
    fields.text("name", cue.name);
    since2("number", cue.number, readNumber);
    since2("note", cue.note, [](const ConfigNode& value) { return value.text(); });
    fields.read("look", cue.look, [&](const ConfigNode& value) { return value.choice(rules.looks); });
    since2("wait", cue.wait, [](const ConfigNode& value) { return readTime(value, kLongestWait); });
    fields.read("fade", cue.fade, [&](const ConfigNode& value) { return readFade(value, rules.version); });
    fields.optional().read("follow", follow, [&](const ConfigNode& value) { return readFollow(value, rules.version); });
    since2("block", cue.blocks, [](const ConfigNode& value) { return value.boolean(); });
    since2("with", cue.with, [&](const ConfigNode& value) { return readWith(value, rules); });
    since2("parts", cue.parts, [&](const ConfigNode& list) -> Result<std::vector<CuePart>> {
        std::vector<CuePart> parts;
        ConfigFaults faults;
        for (const ConfigNode& item : TRY(list.items(1)))
            faults.take(readPart(item, rules), [&](CuePart part) { parts.push_back(std::move(part)); });
        TRY(faults.result());
        return parts;
    });
    TRY(fields.finish());
    if (!follow) return cue;
    cue.follow = follow->time + (follow->from == Follow::From::Fade ? cue.length() : Time{});
    if (follow->from == Follow::From::Media) cue.mediaEnd = follow->at;
    cue.times = follow->times;
    to = std::move(follow->to);
    return cue;
}

// Gives a cue without a number the next whole one. Error: the number is not above that of the cue
// before.
Result<void> giveNumber(Cue& cue, CueNumber before, const ConfigNode& at) {
    if (cue.number == 0) cue.number = (before / kThousandths + 1) * kThousandths;
    if (cue.number > before) return {};
    return at.error(fmt::format("cue {} comes after cue {}; numbers go up from cue to cue", textOf(cue.number), textOf(before)));
}

}  // namespace

std::string textOf(CueNumber number) { return shortest(static_cast<double>(number) / static_cast<double>(kThousandths)); }

std::string placeOf(CueNumber number, int cue, int cues) {
    const std::string place = fmt::format("{} of {}", cue + 1, cues);
    return number == (cue + 1) * kThousandths ? place : fmt::format("{} ({})", textOf(number), place);
}

Result<void> needsTracking(const ConfigNode& node, std::string_view what, std::int64_t version) {
    if (version >= kTrackingVersion) return {};
    return node.error(
        fmt::format("'{}' needs 'version: {}' in this file; docs/show-format.md says what that changes", what, kTrackingVersion));
}

Time Cue::length() const {
    Time end = wait + fade.longer();
    for (const CuePart& part : parts) end = std::max(end, part.wait.value_or(wait) + part.fade.value_or(fade).longer());
    return end;
}

std::optional<Time> Cue::soonestFollow() const {
    return follow && mediaEnd ? std::max(kShortestLoop, length() + *follow) : follow;
}

Result<bool> readAtEnd(const ConfigNode& node) { return TRY(node.choice({"stay", "loop"})) == 1; }

Result<std::size_t> readStart(const ConfigNode& node, const std::vector<Cue>& cues, const std::vector<std::string>& others) {
    std::vector<std::string> names = namesOf(cues);
    for (const std::string& start : others) {
        if (std::ranges::find(names, start) != names.end() && TRY(node.text()) == start)
            return node.error(fmt::format("'{}' is no cue here, but a cue is called so, too; rename the cue", start));
        names.emplace_back(start);
    }
    return node.choice(names);
}

Result<std::vector<Cue>> readCues(const ConfigNode& node, const CueRules& rules) {
    std::vector<Cue> cues;
    std::vector<std::vector<ConfigNode>> followers;  // of each cue, by name
    const auto items = TRY(node.items(1));
    ConfigFaults faults;
    for (const ConfigNode& item : items) {
        std::vector<ConfigNode> to;
        faults.take(readCue(item, rules, to), [&](Cue cue) {
            const auto same = [&](const Cue& other) { return other.name == cue.name; };
            if (std::any_of(cues.begin(), cues.end(), same))
                faults.add(item.error(fmt::format("another cue is called '{}'; each needs its own name", cue.name)));
            if (const auto given = giveNumber(cue, cues.empty() ? 0 : cues.back().number, item); !given)
                faults.add(given.error());
            cues.push_back(std::move(cue));
            followers.push_back(std::move(to));
        });
    }
    TRY(faults.result());
    std::vector<std::string> names;
    for (const Cue& cue : cues) names.push_back(cue.name);
    for (std::size_t cue = 0; cue < cues.size(); ++cue)
        for (const ConfigNode& to : followers[cue])
            faults.take(to.choice(names), [&](std::size_t index) { cues[cue].followers.push_back(static_cast<int>(index)); });
    TRY(faults.result());
    if (cues.back().follow && cues.back().followers.empty() && !rules.loops)
        return items.back().error(fmt::format("no cue comes after this one; remove its 'follow'{}",
                                              rules.version < kTrackingVersion ? "" : ", or add 'at_end: loop' to the show"));
    if (const auto cue = hurriedLoop(cues, rules.loops))
        return items[*cue].error(
            fmt::format("from this cue on, cues follow each other in a circle in less than {:g} s, which would never end; "
                        "give one of them a longer 'follow'",
                        seconds(kShortestLoop)));
    return cues;
}

}  // namespace fantascope::show
