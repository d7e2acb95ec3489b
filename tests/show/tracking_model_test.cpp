// What a cue of a random show looks like, against its definition: each thing is as the nearest cue
// before says that names it, but for cues that block. The program goes forwards through the list;
// this goes backwards from the cue.

#include "show/show.h"

#include "scratch_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::show {
namespace {

const std::vector<std::string> kOutputs = {"left", "right"}, kRelays = {"fog", "road"}, kSources = {"red", "blue"},
                               kLevels = {"gate", "tree.red", "tree.blue"};

Site siteOfTwo() {
    Site site;
    site.outputs.resize(2);
    for (std::size_t i = 0; i < 2; ++i) site.outputs[i].name = site.outputs[i].canvas = kOutputs[i];
    site.fixtures = {{"gate", 1, 1, {"intensity"}}, {"tree", 1, 2, {"red", "blue"}}};
    site.relays = {{"fog", 0, 0, false}, {"road", 0, 1, true}};
    return site;
}

// What a look names: nothing of what is not there.
struct Named {
    std::map<std::string, std::map<std::string, double>> outputs;  // opacities by source
    std::map<std::string, double> levels, speeds;
    std::map<std::string, bool> relays;
};
struct Step {
    Named look;
    bool blocks;
};

double anyTenth() { return *rc::gen::inRange(0, 11) / 10.0; }
bool chance(int of) { return *rc::gen::inRange(0, of) == 0; }

Named anyNames() {
    Named named;
    for (const std::string& output : kOutputs)
        if (chance(2))
            for (named.outputs[output]; const std::string& source : kSources)
                if (chance(2)) named.outputs[output][source] = anyTenth();
    for (const std::string& level : kLevels)
        if (chance(2)) named.levels[level] = anyTenth();
    for (const std::string& relay : kRelays)
        if (chance(2)) named.relays[relay] = chance(2);
    for (const std::string& source : kSources)
        if (chance(3)) named.speeds[source] = anyTenth();
    return named;
}

std::string textOf(const std::vector<Step>& steps) {
    const auto map = [](const auto& entries, auto write) {
        std::vector<std::string> texts;
        for (const auto& [key, value] : entries) texts.push_back(fmt::format("{}: {}", key, write(value)));
        return fmt::format("{{{}}}", fmt::join(texts, ", "));
    };
    const auto number = [](double value) { return fmt::format("{}", value); };
    std::string looks = "looks:\n", cues = "cues:\n";
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const Named& look = steps[i].look;
        std::map<std::string, std::string> fixtures;
        std::map<std::string, double> tree;
        for (const auto& [level, value] : look.levels)
            if (level == "gate")
                fixtures["gate"] = number(value);
            else
                tree[level.substr(5)] = value;
        if (!tree.empty()) fixtures["tree"] = map(tree, number);
        const auto layers = [](const std::map<std::string, double>& opacities) {
            std::vector<std::string> texts;
            for (const auto& [source, opacity] : opacities)
                texts.push_back(fmt::format("{{source: {}, opacity: {}}}", source, opacity));
            return fmt::format("[{}]", fmt::join(texts, ", "));
        };
        looks += fmt::format("  l{}: {{outputs: {}, fixtures: {}, relays: {}, play: {}}}\n", i, map(look.outputs, layers),
                             map(fixtures, [](const std::string& text) { return text; }),
                             map(look.relays, [](bool on) { return on ? "on" : "off"; }), map(look.speeds, number));
        cues += fmt::format("  - {{name: c{}, look: l{}, fade: 1, block: {}}}\n", i, i, steps[i].blocks);
    }
    return "fantascope: show\nversion: 2\ntitle: Any\nsources: {red: {solid: [1, 0, 0]}, blue: {solid: [0, 0, 1]}}\n" + looks +
           cues;
}

// What the nearest cue from `step` back says of a thing; nothing: it is dark.
template <class Value>
std::optional<Value> seenIn(const std::vector<Step>& steps, std::size_t step, const std::string& thing,
                            std::map<std::string, Value> Named::*of) {
    for (std::size_t back = step + 1; back-- > 0;) {
        const auto& named = steps[back].look.*of;
        if (const auto found = named.find(thing); found != named.end()) return found->second;
        if (steps[back].blocks) return std::nullopt;
    }
    return std::nullopt;
}

// Example failures: a cue that blocks keeps a speed; an output that is named without layers is left
// as before; a channel that is not named goes out with its fixture.
TEST(Tracking, is_what_the_nearest_cue_before_says) {
    const Site site = siteOfTwo();
    EXPECT_TRUE(rc::check("each cue's look is its definition", [&] {
        std::vector<Step> steps;
        for (int count = *rc::gen::inRange(1, 9); count > 0; --count) steps.push_back({anyNames(), chance(4)});
        const ScratchFolder folder;
        const std::string text = textOf(steps);
        RC_LOG(text);
        const auto show = Show::load(folder.file("show.yaml", text));
        RC_ASSERT(show.has_value());
        const auto list = show->bind(site);
        RC_ASSERT(list.has_value());
        for (std::size_t step = 0; step < steps.size(); ++step) {
            const CueList::Cue& cue = list->cues[step];
            for (std::size_t i = 0; i < kOutputs.size(); ++i) {
                std::map<std::string, double> layers;
                for (const LayerState& layer : cue.look.outputs[i].layers)
                    layers[kSources[layer.source.value]] = std::round(10 * double(layer.opacity)) / 10;
                RC_ASSERT(layers == seenIn(steps, step, kOutputs[i], &Named::outputs).value_or(std::map<std::string, double>()));
            }
            for (std::size_t i = 0; i < kLevels.size(); ++i)
                RC_ASSERT(cue.look.levels[i] == float(seenIn(steps, step, kLevels[i], &Named::levels).value_or(0)));
            for (std::size_t i = 0; i < kRelays.size(); ++i)
                RC_ASSERT((cue.look.relays[i] != 0) ==
                          seenIn(steps, step, kRelays[i], &Named::relays).value_or(site.relays[i].safe));
            for (std::uint32_t i = 0; i < kSources.size(); ++i)
                RC_ASSERT(cue.speedOf({i}) == float(seenIn(steps, step, kSources[i], &Named::speeds).value_or(1)));
        }
    }));
}

}  // namespace
}  // namespace fantascope::show
