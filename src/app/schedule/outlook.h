#pragma once
// What a schedule brings, in words. Times are by the clocks of the place. Revisions have a
// schedule.

#include "show/played_show.h"
#include "show/revision.h"
#include "show/schedule/nights.h"

#include "core/clock.h"
#include "core/wall_clock.h"

#include <string>

namespace fantascope::app {

// "'Night' since 21:15", "dark since 23:00".
std::string wordsOf(const show::Nights::Moment& moment, const show::Revision& revision);
// What comes next: "16:17 Night"; with its date from a day away on. Empty: nothing within a year.
std::string nextOf(const show::Revision& revision, Time utc);
// The same, worked out again only when it changes. Thread: one at a time.
class Outlook {
public:
    // `show` outlives this. Empty where it has no schedule.
    explicit Outlook(const show::PlayedShow& show) : show_(show) {}
    const std::string& at(Time utc);

private:
    const show::PlayedShow& show_;
    const show::Revision* revision_ = nullptr;  // that `text_` is of
    std::string text_;
    Time from_ = Time::max(), until_{};  // UTC, in which `text_` holds
};

// The moments of the next 24 hours, a line each, and what is on now.
std::string nextDayOf(const show::Revision& revision, Time utc);
// "Thu 24 Dec 2026, 16:17".
std::string dayAndClockOf(const WallTime& time);

}  // namespace fantascope::app
