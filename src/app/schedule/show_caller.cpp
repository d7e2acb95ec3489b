#include "app/schedule/show_caller.h"

#include "app/schedule/outlook.h"

#include <chrono>
#include <utility>

namespace fantascope::app {

namespace {

using show::Nights;

// A clock that is set back by less calls no cue again.
constexpr Time kSetBack = std::chrono::minutes(10);
// A cue that is called so late is joined; else it begins.
constexpr Time kLate = std::chrono::seconds(5);
constexpr Time kClockIsSet = std::chrono::seconds(2);  // a smaller difference is no news

}  // namespace

ShowCaller::ShowCaller(const Nights* nights, const show::Show& show, show::InputLog& inputs, show::EventLog& events,
                       const WallClock& wall, const show::ShowClock& showClock)
    : nights_(nights), show_(show), inputs_(inputs), events_(events), wall_(wall), showClock_(showClock), replica_(inputs) {}

void ShowCaller::begin(std::optional<Time> followed) {
    if (nights_ == nullptr) return;
    if (followed) called_ = nights_->at(*followed);
    events_.append({showClock_.showTime(showClock_.runStart()), show::event::NextDayTold{nextDay()}});
    tick(showClock_.runStart());
}

std::string ShowCaller::nextDay() const { return nights_ == nullptr ? "" : nextDayOf(*nights_, show_, wall_.now().utc); }

void ShowCaller::tick(Time moment) {
    if (nights_ == nullptr) return;
    const Time utc = wall_.now().utc, showTime = showClock_.showTime(moment);
    tellOfClock(utc, moment);
    if (!stretch_ || utc < stretch_->begin.utc || utc >= stretch_->end) stretch_ = nights_->stretchAt(utc);
    const Nights::Moment& due = stretch_->begin;
    if (isCalled(due, utc)) return;
    replica_.stateAt(showTime, state_);
    if (state_.panic) return;
    const Time ago = utc - due.utc;
    if (due.cue >= 0 || state_.cue >= 0) {
        events_.append({showTime, show::event::ScheduleCalled{.what = wordsOf(due, *nights_, show_), .joins = ago > kLate}});
        inputs_.submit({.at = showTime,
                        .kind = show::Input::Kind::Jump,
                        .cue = due.cue,
                        .source = show::Input::Source::Schedule,
                        .ago = due.cue >= 0 && ago > kLate ? ago : Time{}});
    }
    called_ = due;
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
                        show::event::ClockSet{.now = dayAndClockOf(nights_->zone().at(utc)), .by = began - before}});
    began_ = began;
}

}  // namespace fantascope::app
