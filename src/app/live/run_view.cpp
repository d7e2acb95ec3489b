#include "app/live/run_view.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>

namespace fantascope::app {

namespace {

// What a person holds by hand: "gate 40 %, fog on".
std::string byHandOf(const show::Controls& controls, const show::Site& site) {
    std::vector<std::string> parts;
    for (const auto& [fixture, level] : controls.raised)
        parts.push_back(fmt::format("{} {:.0f} %", site.fixtures[static_cast<std::size_t>(fixture)].name, 100 * level));
    for (const auto& [relay, on] : controls.switched)
        parts.push_back(fmt::format("{} {}", site.relays[static_cast<std::size_t>(relay)].name, on ? "on" : "off"));
    return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

RunStatus RunView::at(Time moment, Time nextGo, int list) {
    const Time time = showClock_.showTime(moment), runTime = showClock_.runTime(moment);
    replica_.stateAt(time, state_);
    const show::Show& show = show_.at(state_.revision).show;
    const auto& cues = show.cues;
    RunStatus status;
    status.showTime = time;
    status.cues = static_cast<int>(cues.size());
    if (state_.cue >= 0) {
        const show::Cue& cue = cues[static_cast<std::size_t>(state_.cue)];
        status.cueName = cue.name;
        status.number = cue.number;
    }
    const auto after = replica_.playback().cues().after(state_.cue), follower = replica_.playback().followerAt(time);
    if (const auto next = follower ? follower : after) {
        status.nextName = cues[static_cast<std::size_t>(*next)].name;
        status.nextNote = cues[static_cast<std::size_t>(*next)].note;
    }
    status.waitLeft = replica_.playback().waitLeftAt(time);
    status.fadeLeft = replica_.playback().fadeLeftAt(time);
    status.untilNext = replica_.playback().untilFollowAt(time);
    if (nextGo != Time::max())
        status.untilNext = std::min(status.untilNext.value_or(Time::max()), std::max(Time{}, nextGo - runTime));
    if (length_) status.left = std::max(Time{}, *length_ - runTime);
    if (follower && after && follower != after) status.loadedName = cues[static_cast<std::size_t>(*after)].name;  // GO's
    if (state_.loaded >= 0) status.loadedName = cues[static_cast<std::size_t>(state_.loaded)].name;
    for (std::size_t side = 0; side < state_.sides.size(); ++side) {
        const show::SideList& sideList = show.sides[side];
        const int which = static_cast<int>(side) + 1;
        RunStatus::Side& told = status.sides.emplace_back(RunStatus::Side{.name = sideList.name, .hasKeys = which == list});
        if (const int cue = state_.sides[side].cue; cue >= 0) told.cueName = sideList.cues[static_cast<std::size_t>(cue)].name;
        const auto next = replica_.playback().followerAt(time, which);
        if (next) told.nextName = sideList.cues[static_cast<std::size_t>(*next)].name;
        told.untilNext = replica_.playback().untilFollowAt(time, which);
    }
    const auto lampOf = [&](int fixture) {
        return show_.at(state_.revision).site.fixtures[static_cast<std::size_t>(fixture)].name;
    };
    if (state_.highlight >= 0) status.highlighted = lampOf(state_.highlight);
    for (const int fixture : state_.parked) status.parked += (status.parked.empty() ? "" : ", ") + lampOf(fixture);
    status.byHand = byHandOf(state_, show_.at(state_.revision).site);
    status.controls = state_;
    if (hasNews()) status.said = std::exchange(news_, {});
    return status;
}

bool RunView::hasNews() {
    while (const show::Event* const event = events_.next())
        if (const std::string sentence = show::sentenceOf(*event); !sentence.empty())
            news_ += (news_.empty() ? "" : news_.find('\n') == std::string::npos ? "; " : "\n") + sentence;
    return !news_.empty();
}

namespace {

// Why everything is dark; empty: it is not.
std::string darknessOf(const show::ShowState& state) {
    if (state.panic) return "everything is dark: PANIC";
    if (state.blackout) return "pictures and lamps are dark: BLACKOUT";
    if (state.solo) return "everything but one lamp is dark: SOLO";
    if (state.master == 0) return "pictures and lamps are dark: the master is at 0";
    return "";
}

}  // namespace

std::string howItIs(const show::ShowState& state, const show::Revision& revision, const std::vector<FaultReport>& faults) {
    std::string lines = darknessOf(state);
    const auto add = [&](const std::string& line) { lines += (lines.empty() ? "" : "\n") + line; };
    const bool isAllDark = !lines.empty();
    for (std::size_t output = 0; !isAllDark && output < state.outputs.size(); ++output) {
        if (!state.outputs[output].layers.empty()) continue;
        const std::string cue = state.cue < 0 ? "no cue is on"
                                              : fmt::format("'{}' shows nothing there, or not yet",
                                                            revision.show.cues[static_cast<std::size_t>(state.cue)].name);
        add(fmt::format("'{}' is dark: {}", revision.site.outputs[output].name, cue));
    }
    for (const int fixture : state.parked)
        add(fmt::format("'{}' is parked", revision.site.fixtures[static_cast<std::size_t>(fixture)].name));
    if (const std::string byHand = byHandOf(state, revision.site); !byHand.empty()) add("by hand: " + byHand);
    for (const FaultReport& fault : faults) add("not well: " + fault.what);
    return lines.empty() ? "every output shows something, and all is well" : lines;
}

std::string namesOf(const std::vector<FaultReport>& faults) {
    std::set<std::string> names;
    for (const FaultReport& fault : faults)
        names.insert(fault.device.empty() ? fault.what.substr(0, fault.what.find(':')) : fault.device);
    return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace fantascope::app
