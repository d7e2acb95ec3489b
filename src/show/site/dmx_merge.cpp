#include "show/site/dmx_merge.h"

#include <algorithm>

namespace fantascope::show {

DmxMerge::DmxMerge(const Settings& settings) : settings_(settings), sources_(kMostSenders) {
    own_.priority = settings.ownPriority;
    own_.changed.fill(Time::min());
    winners_.reserve(kMostSenders + 1);
    inCharge_.reserve(kMostSenders + 1);
}

void DmxMerge::setSlots(Source& source, std::span<const std::uint8_t, 512> slots, Time when) {
    for (std::size_t slot = 0; slot < slots.size(); ++slot) {
        if (source.slots[slot] == slots[slot]) continue;
        source.slots[slot] = slots[slot];
        source.changed[slot] = when;
    }
}

void DmxMerge::receive(const DmxFrame& frame) {
    inCharge_.clear();
    const auto there = sources_.begin() + static_cast<std::ptrdiff_t>(count_);
    const auto found = std::find_if(sources_.begin(), there, [&](const Source& source) { return source.sender == frame.sender; });
    if (frame.ended) {
        if (found == there) return;
        std::rotate(found, found + 1, there);
        --count_;
        return;
    }
    if (found == there) {
        if (count_ == kMostSenders) return;
        ++count_;
        found->sender = frame.sender;
        found->slots.fill(0);
        found->changed.fill(Time::min());
    }
    found->priority = frame.priority;
    found->arrived = frame.arrived;
    found->silence = frame.silence;
    setSlots(*found, frame.slots, frame.arrived);
}

void DmxMerge::mergeAt(Time now, std::span<const std::uint8_t, 512> own, std::span<const std::uint8_t, 512> asked,
                       std::span<std::uint8_t, 512> out) {
    for (std::size_t slot = 0; slot < asked_.size(); ++slot)
        if (claims_ && asked[slot] != asked_[slot]) own_.changed[slot] = now;
    std::ranges::copy(asked, asked_.begin());
    std::ranges::copy(own, own_.slots.begin());
    // A silent desk keeps its place until its settling time is over.
    const auto isOver = [&](const Source& source) { return now - source.arrived > source.silence + settings_.settling; };
    for (std::size_t i = 0; i < count_;) {
        if (!isOver(sources_[i])) {
            ++i;
            continue;
        }
        std::rotate(sources_.begin() + static_cast<std::ptrdiff_t>(i), sources_.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                    sources_.begin() + static_cast<std::ptrdiff_t>(count_));
        --count_;
    }

    const std::span<const Source> there = std::span(sources_).first(count_);
    int highest = own_.priority;
    for (const Source& source : there) highest = std::max(highest, source.priority);
    bool anyLive = own_.priority == highest;
    for (const Source& source : there) anyLive = anyLive || (source.priority == highest && isLive(source, now));

    winners_.clear();
    inCharge_.clear();
    if (own_.priority == highest) {
        winners_.push_back(&own_);
        inCharge_.push_back({"", own_.priority, false});
    }
    for (const Source& source : there) {
        if (source.priority != highest || (anyLive && !isLive(source, now))) continue;
        winners_.push_back(&source);
        inCharge_.push_back({source.sender, source.priority, !anyLive});
    }

    for (std::size_t slot = 0; slot < out.size(); ++slot) {
        const Source* best = winners_.front();
        for (const Source* const source : winners_) {
            const bool wins = settings_.rule == Rule::Highest ? source->slots[slot] > best->slots[slot]
                                                              : source->changed[slot] > best->changed[slot];
            if (wins) best = source;
        }
        out[slot] = best->slots[slot];
    }
}

}  // namespace fantascope::show
