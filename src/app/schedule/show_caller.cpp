#include "app/schedule/show_caller.h"

#include "app/schedule/outlook.h"

#include <chrono>
#include <cstddef>
#include <string>

namespace fantascope::app {

namespace {

using show::Nights;

// A clock that is set back by less calls no cue again.
constexpr Time kSetBack = std::chrono::minutes(10);
// A cue that is called so late is joined; else it begins.
constexpr Time kLate = std::chrono::seconds(5);
constexpr Time kClockIsSet = std::chrono::seconds(2);  // a smaller difference is no news

}  // namespace

ShowCaller::ShowCaller(const show::PlayedShow& show, show::InputLog& inputs, show::EventLog& events, const WallClock& wall,
                       const show::ShowClock& showClock)
    : show_(show),
      revision_(&show.newest()),
      inputs_(inputs),
      events_(events),
      wall_(wall),
      showClock_(showClock),
      replica_(inputs) {}

void ShowCaller::begin(std::optional<Time> followed) {
    if (!revision_->nights) return;
    if (followed) called_ = revision_->nights->at(*followed);
    events_.append({showClock_.showTime(showClock_.runStart()), show::event::NextDayTold{nextDay()}});
    tick(showClock_.runStart());
}

std::string ShowCaller::nextDay() const {
    const show::Revision& revision = show_.newest();
    return revision.nights ? nextDayOf(revision, wall_.now().utc) : "";
}

void ShowCaller::tick(Time moment) {
    const auto still = show_.still();
    const show::Revision& newest = show_.newest();
    if (!newest.nights && !revision_->nights) return;
    const Time utc = wall_.now().utc, showTime = showClock_.showTime(moment);
    if (&newest != revision_) follow(newest, utc);
    if (!revision_->nights) return;
    const Nights& nights = *revision_->nights;
    tellOfClock(utc, moment);
    if (!stretch_ || utc < stretch_->begin.utc || utc >= stretch_->end) stretch_ = nights.stretchAt(utc);
    const Nights::Moment& due = stretch_->begin;
    if (isCalled(due, utc)) return;
    replica_.stateAt(showTime, state_);
    if (state_.panic) return;
    const Time ago = utc - due.utc;
    if (due.cue >= 0 || state_.cue >= 0) {
        events_.append({showTime, show::event::ScheduleCalled{.what = wordsOf(due, *revision_), .joins = ago > kLate}});
        inputs_.submit({.at = showTime,
                        .kind = show::Input::Kind::Jump,
                        .cue = due.cue,
                        .source = show::Input::Source::Schedule,
                        .ago = due.cue >= 0 && ago > kLate ? ago : Time{}});
    }
    called_ = due;
}

// The show was revised.
void ShowCaller::follow(const show::Revision& revision, Time utc) {
    const auto nameOf = [](const Nights::Moment& moment, const show::Revision& of) {
        return moment.cue < 0 ? std::string() : of.show.cues[static_cast<std::size_t>(moment.cue)].name;
    };
    if (called_ && revision.nights) {
        const Nights::Moment due = revision.nights->at(utc);
        if (nameOf(due, revision) == nameOf(*called_, *revision_)) called_ = due;
    }
    stretch_.reset();
    revision_ = &revision;
}

bool ShowCaller::isCalled(const Nights::Moment& due, Time utc) const {
    // It is dark already, or somebody has lit it between two nights.
    if (due.cue == Nights::kDark && (!called_ || called_->cue == Nights::kDark)) return true;
    if (!called_) return false;
    return due == *called_ || (utc < called_->utc && called_->utc - utc < kSetBack);
}

void ShowCaller::tellOfClock(Time utc, Time moment) {
    const Time began = utc - showClock_.showTime(moment);
    if (const Time before = began_.value_or(began); std::chrono::abs(began - before) > kClockIsSet)
        events_.append({showClock_.showTime(moment),
                        show::event::ClockSet{.now = dayAndClockOf(revision_->nights->zone().at(utc)), .by = began - before}});
    began_ = began;
}

}  // namespace fantascope::app
