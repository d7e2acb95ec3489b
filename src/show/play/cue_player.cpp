#include "show/play/cue_player.h"

#include "show/follow_loops.h"

#include "core/check.h"
#include "core/random.h"

#include <algorithm>
#include <iterator>
#include <ranges>
#include <utility>

namespace fantascope::show {

namespace {

using Position = CuePlayer::Position;

// What follows a cue by itself; nothing: it waits for an input.
std::optional<Position> followerOf(const CueList& list, const Position& now) {
    if (now.cue < 0) return std::nullopt;
    const CueList::Cue& cue = list.cues[static_cast<std::size_t>(now.cue)];
    const auto follow = cue.usualFollow();
    if (!follow) return std::nullopt;
    Position next{-1, now.entered + *follow, now.follows + 1, now.turns};
    int unlimited = 0;
    int& turns = cue.times > 0 ? next.turns[now.cue] : unlimited;
    if (!cue.followers.empty() && (cue.times == 0 || turns < cue.times)) {
        ++turns;
        const std::uint64_t chance =
            streamSeed(list.seed, {static_cast<std::uint64_t>(now.cue), static_cast<std::uint64_t>(now.follows)});
        next.cue = cue.followers[chance % cue.followers.size()];
        return next;
    }
    next.turns.erase(now.cue);
    const auto after = list.after(now.cue);
    if (!after) return std::nullopt;
    next.cue = *after;
    return next;
}

// The dark before the first cue, as a cue.
CueList::Cue darkOf(const CueList& list) { return {.look = list.dark, .fade = list.darkFade, .follow = {}}; }

// A cue, and what has followed it by `at`. A cue that is entered at `at` begins as any other.
std::vector<Position> wayOf(const CueList& list, const Position& first, Time at) {
    std::vector<Position> way{first};
    while (way.back().entered < at) {
        const auto next = followerOf(list, way.back());
        if (!next || next->entered > at) break;
        way.push_back(*next);
    }
    return way;
}

// What a list brings on its way from cue `before` over others.
std::vector<CuePlayer::Brought> broughtOn(std::span<const Position> way, int before, const CueList& list) {
    std::vector<std::optional<CuePlayer::Brought>> newest(list.sides.size());
    for (const auto& [cue, entered, follows, turns] : way) {
        for (std::size_t side = 0; side < newest.size(); ++side)
            if (cue < 0)
                newest[side] = {side, -1, entered};
            else if (const auto start = list.sides[side]->start; before < 0 && start)
                newest[side] = {side, *start, entered};
        if (cue >= 0)
            for (const auto& with : list.cues[static_cast<std::size_t>(cue)].with)
                newest[with.list] = {with.list, with.cue, entered};
        before = cue;
    }
    std::vector<CuePlayer::Brought> brought;
    for (const auto& one : newest)
        if (one) brought.push_back(*one);
    return brought;
}

}  // namespace

bool isOfOneSite(const Look& a, const Look& b) {
    return a.outputs.size() == b.outputs.size() && a.levels.size() == b.levels.size() && a.relays.size() == b.relays.size();
}

FoundCue foundAgain(int cue, const CueList& old, const CueList& list) {
    for (int before = cue; before >= 0; --before) {
        const auto found = std::ranges::find(list.cues, old.cues[static_cast<std::size_t>(before)].name, &CueList::Cue::name);
        if (found != list.cues.end()) return {static_cast<int>(found - list.cues.begin()), before == cue};
    }
    return {-1, cue < 0};
}

CuePlayer::CuePlayer(std::shared_ptr<const CueList> list) {
    examine(*list);
    entries_.push_back({.list = list, .next = {}, .seen = LookCourses(list->dark)});
}

// Checks the looks of another list, and notes how much room they need.
void CuePlayer::examine(const CueList& list) {
    for (const CueList::Cue& cue : list.cues) {
        FANTASCOPE_CHECK(isOfOneSite(cue.look, list.dark), "all looks of a cue list are for one site");
        for (const OutputState& output : cue.look.outputs) {
            for (const LayerState& layer : output.layers) sources_.insert(layer.source);
            composed_.layers += output.pictures.empty() ? 0 : output.layers.size();
            composed_.pictures += output.pictures.size();
        }
    }
    FANTASCOPE_CHECK(!hurriedLoop(list.cues, list.loops), "a circle of cues that follow each other takes time");
}

bool CuePlayer::needs(SourceId source, Time time) const {
    const auto isIn = [&](const OutputState& output) {
        return std::ranges::find(output.layers, source, &LayerState::source) != output.layers.end();
    };
    const auto hasIt = [&](const CueList::Cue& cue) { return std::ranges::any_of(cue.look.outputs, isIn); };
    if (std::ranges::any_of(cues().cues, hasIt) || at(time).seen.shows(source, time)) return true;
    return std::ranges::any_of(entries_,
                               [&](const Entry& entry) { return entry.at > time && entry.seen.shows(source, entry.at); });
}

LookCourses::Room CuePlayer::room() const { return {sources_.size() + composed_.layers, composed_.pictures}; }

void CuePlayer::enter(int cue, Time at, Time ago) {
    std::shared_ptr<const CueList> list = this->at(at).list;
    const std::vector<Position> way = wayOf(*list, {cue, at - ago}, at);
    begin(std::move(list), way, at);
    followOn();
}

// Adds the entries of the last cue of a way, which was entered at `at` or before and is seen from
// `at` on. Later entries are dropped.
void CuePlayer::begin(std::shared_ptr<const CueList> list, std::span<const Position> way, Time at) {
    const auto& [cue, entered, follows, turns] = way.back();
    const bool hasBegun = entered < at;
    const CueList::Cue dark = cue < 0 ? darkOf(*list) : CueList::Cue();
    const CueList::Cue& wanted = cue < 0 ? dark : list->cues[static_cast<std::size_t>(cue)];
    const Time least = hasBegun ? list->blackoutFade : Time{};
    drop(at);
    Entry entry{
        .at = at, .list = list, .cue = cue, .entered = entered, .next = {}, .number = ++begun_, .seen = entries_.back().seen};
    entry.whole = std::max(entered + wanted.length(), at + least);
    entry.next = followerOf(*list, way.back());
    entry.brings = broughtOn(way, entries_.back().cue, *list);
    move(std::move(entry), wanted, least, hasBegun);
    followMedia(wanted);
}

// Works out when what plays in the newest cue is over, so that another one follows.
void CuePlayer::followMedia(const CueList::Cue& cue) {
    if (cue.endings.empty() || !entries_.back().next) return;
    const Entry& last = entries_.back();
    std::optional<Time> over = last.entered + cue.length();
    for (const auto& [source, length] : cue.endings) {
        const auto end = last.seen.whenOver(source, length, last.at);
        over = over && end ? std::optional(std::max(*over, *end)) : std::nullopt;
    }
    for (Entry& entry : entries_ | std::views::reverse) {
        if (entry.number != last.number) break;
        if (over)
            entry.next->entered = std::max({last.at, last.entered + kShortestLoop, *over + *cue.follow});
        else
            entry.next.reset();
    }
}

// Adds an entry that goes on with what is seen, and one for each further moment at which the cue
// begins to move something. The cue was entered at `entry.entered`. `hasBegun`: sources that come
// at once play as if they had come with the cue.
void CuePlayer::move(Entry entry, const CueList::Cue& wanted, Time least, bool hasBegun) {
    entries_.push_back(std::move(entry));
    for (Movement& movement : wanted.movements(entries_.back().entered, entries_.back().at, least)) {
        Entry& last = entries_.back();
        if (last.cue < 0) std::ranges::replace(movement.relays, Movement::Relay::Switches, Movement::Relay::Releases);
        movement.begun = hasBegun ? std::min(movement.start, last.entered + wanted.wait) : movement.start;
        if (movement.start > last.at) {
            Entry later = last;
            later.at = movement.start;
            later.brings.clear();
            entries_.push_back(std::move(later));
        }
        entries_.back().seen = entries_.back().seen.moved(movement, wanted);
    }
}

// Drops what was to come after `at`.
void CuePlayer::drop(Time at) {
    while (entries_.back().at > at) entries_.pop_back();
}

// Adds the cues that follow the last entry, at most one pass of the list.
void CuePlayer::followOn() {
    const std::size_t most = cues().cues.size();
    for (std::size_t added = 0; added < most; ++added) {
        const Entry& last = entries_.back();
        if (!last.next) return;
        const Position next = *last.next;
        begin(last.list, {&next, 1}, next.entered);
    }
}

void CuePlayer::foresee(Time time, Time kept) {
    const auto forget = [&] {
        const auto next = std::ranges::find_if(entries_, [&](const Entry& entry) { return entry.at > kept; });
        if (next - entries_.begin() > 1) entries_.erase(entries_.begin(), next - 1);
        std::erase_if(ended_, [&](const Ended& ended) { return ended.at <= kept; });
    };
    while (entries_.back().entered <= time && entries_.back().next) {
        followOn();
        forget();
    }
    forget();
}

void CuePlayer::enterBrought(int cue, Time at, Time ago) {
    const auto rest = std::ranges::find_if(entries_, [&](const Entry& entry) { return entry.at > at; });
    ended_.push_back({at, begun_, {std::make_move_iterator(rest), std::make_move_iterator(entries_.end())}});
    entries_.erase(rest, entries_.end());
    enter(cue, at, ago);
}

void CuePlayer::takeBack(Time time) {
    for (; !ended_.empty() && ended_.back().at > time; ended_.pop_back()) {
        while (entries_.back().number > ended_.back().number) entries_.pop_back();
        std::ranges::move(ended_.back().rest, std::back_inserter(entries_));
    }
    ended_.clear();  // nobody asks for an earlier time
}

void CuePlayer::revise(std::shared_ptr<const CueList> list, Time at) {
    const Entry& now = this->at(at);
    FANTASCOPE_CHECK(isOfOneSite(list->dark, now.list->dark), "all lists are for one site");
    examine(*list);
    const auto [cue, isThere] = foundAgain(now.cue, *now.list, *list);
    Entry entry{.at = at, .list = list, .cue = cue, .entered = now.entered, .whole = now.whole, .next = {}, .seen = now.seen};
    entry.isGone = !isThere || now.isGone;
    entry.number = ++begun_;
    drop(at);
    if (entry.isGone) {
        entries_.push_back(std::move(entry));
    } else if (cue < 0) {
        entry.entered = at;
        move(std::move(entry), darkOf(*list), Time{}, false);
    } else {
        const CueList::Cue& wanted = list->cues[static_cast<std::size_t>(cue)];
        entry.whole = std::max(entry.entered + wanted.length(), at + list->blackoutFade);
        entry.next = followerOf(*list, {cue, entry.entered});
        if (entry.next) entry.next->entered = std::max(at, entry.next->entered);
        move(std::move(entry), wanted, list->blackoutFade, false);
        followMedia(wanted);
    }
    followOn();
}

const CuePlayer::Entry& CuePlayer::at(Time time) const {
    const auto next =
        std::upper_bound(entries_.begin(), entries_.end(), time, [](Time t, const Entry& entry) { return t < entry.at; });
    return next == entries_.begin() ? entries_.front() : *std::prev(next);
}

Time CuePlayer::fadeLeftAt(Time time) const {
    const Entry& entry = at(time);
    if (entry.cue < 0) return Time{};
    return std::max(Time{}, entry.whole - time);
}

Time CuePlayer::waitLeftAt(Time time) const {
    const Entry& entry = at(time);
    if (entry.cue < 0 || entry.isGone) return Time{};
    return std::max(Time{}, entry.entered + entry.list->cues[static_cast<std::size_t>(entry.cue)].firstWait() - time);
}

std::optional<Time> CuePlayer::untilFollowAt(Time time) const {
    const auto& next = at(time).next;
    return next ? std::optional(next->entered - time) : std::nullopt;
}

std::optional<int> CuePlayer::followerAt(Time time) const {
    const auto& next = at(time).next;
    return next ? std::optional(next->cue) : std::nullopt;
}

}  // namespace fantascope::show
