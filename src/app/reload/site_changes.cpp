#include "app/reload/site_changes.h"

#include "core/config/config.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string_view>

namespace fantascope::app {

namespace {

// The keys of an output that its projection is read from.
constexpr std::string_view kProjected[] = {"part", "flip", "turn", "corners", "mesh", "masks", "light"};

// The keys whose values are not the same in two maps.
Result<std::vector<std::string>> differing(const ConfigNode& one, const ConfigNode& other) {
    std::vector<std::string> keys;
    for (const auto& [key, value] : TRY(one.entries()))
        if (const auto there = other.find(key); !there || !(*there == value)) keys.push_back(key);
    for (const auto& [key, value] : TRY(other.entries()))
        if (!one.find(key)) keys.push_back(key);
    return keys;
}

}  // namespace

Result<SiteChanges> changesOf(const show::Site& began, const show::Site& saved) {
    const ConfigNode before = TRY(ConfigNode::parse(began.text, began.file)),
                     now = TRY(ConfigNode::parse(saved.text, saved.file));
    SiteChanges changes{.later = TRY(differing(before, now))};
    std::erase(changes.later, "outputs");
    const auto isSame = [](const show::Output& one, const show::Output& other) {
        return one.name == other.name && one.size() == other.size();
    };
    changes.hasSameOutputs = std::ranges::equal(began.outputs, saved.outputs, isSame);
    if (!changes.hasSameOutputs) {
        changes.later.emplace_back("outputs");
        return changes;
    }
    const auto outputsBefore = TRY(before.find("outputs")->items()), outputsNow = TRY(now.find("outputs")->items());
    for (std::size_t output = 0; output < outputsNow.size(); ++output)
        for (const std::string& key : TRY(differing(outputsBefore[output], outputsNow[output])))
            if (std::ranges::find(kProjected, key) == std::end(kProjected))
                changes.later.push_back(fmt::format("outputs[{}].{}", output, key));
    return changes;
}

}  // namespace fantascope::app
