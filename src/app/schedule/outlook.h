#pragma once
// What a schedule brings, in words. Times are by the clocks of the place.

#include "show/schedule/nights.h"
#include "show/show.h"

#include "core/clock.h"
#include "core/wall_clock.h"

#include <string>

namespace fantascope::app {

// "'Night' since 21:15", "dark since 23:00".
std::string wordsOf(const show::Nights::Moment& moment, const show::Nights& nights, const show::Show& show);
// What comes next: "16:17 Night"; with its date from a day away on. Empty: nothing within a year.
std::string nextOf(const show::Nights& nights, const show::Show& show, Time utc);
// The same, worked out again only when it changes. Thread: one at a time.
class Outlook {
public:
    // Both outlive this. `nights`: null if there is no schedule; then it is always empty.
    Outlook(const show::Nights* nights, const show::Show& show) : nights_(nights), show_(show) {}
    const std::string& at(Time utc);

private:
    const show::Nights* const nights_;
    const show::Show& show_;
    std::string text_;
    Time from_ = Time::max(), until_{};  // UTC, in which `text_` holds
};

// The moments of the next 24 hours, a line each, and what is on now.
std::string nextDayOf(const show::Nights& nights, const show::Show& show, Time utc);
// "Thu 24 Dec 2026, 16:17".
std::string dayAndClockOf(const WallTime& time);

}  // namespace fantascope::app
