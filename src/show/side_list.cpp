#include "show/side_list.h"

#include "show/names.h"

#include <fmt/format.h>

#include <utility>

namespace fantascope::show {

namespace {

Result<SideList> readSide(const std::string& name, const ConfigNode& node, CueRules rules) {
    SideList side{.at = node.here(), .name = name, .cues = {}, .start = {}};
    ConfigFields fields(node);
    fields.optional().read("at_end", side.loops, readAtEnd);
    rules.loops = side.loops;
    fields.read("cues", side.cues, [&](const ConfigNode& value) { return readCues(value, rules); });
    std::size_t start = side.cues.size();  // dark
    fields.optional().read("start", start, [&](const ConfigNode& value) {
        return side.cues.empty() ? Result(start) : readStart(value, side.cues, {"dark"});  // faulty cues are told already
    });
    TRY(fields.finish());
    if (start < side.cues.size()) side.start = start;
    return side;
}

}  // namespace

Result<std::vector<SideList>> readSides(const ConfigNode& node, CueRules& rules) {
    const auto entries = TRY(node.entries());
    if (entries.empty()) return node.error("there is no list here; remove 'lists'");
    if (entries.size() > kMostSides) return node.error(fmt::format("at most {} lists play beside the show's cues", kMostSides));
    std::vector<SideList> sides;
    ConfigFaults faults;
    const CueRules ofSides = rules;  // their cues bring no others
    for (const auto& [name, list] : entries) {
        rules.sides.push_back({name, {}});
        faults.take(readSide(name, list, ofSides), [&](SideList side) {
            rules.sides.back().cues = namesOf(side.cues);
            sides.push_back(std::move(side));
        });
    }
    TRY(faults.result());
    return sides;
}

}  // namespace fantascope::show
