#include "show/play/show_clock.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>

namespace fantascope::show {

ShowClock::ShowClock(Time runStart, Time showAtStart) : runStart_(runStart), stretches_{{runStart, showAtStart, 1}} {}

Time ShowClock::Stretch::showTimeAt(Time at) const {
    if (rate == 1) return showTime + (at - moment);
    return showTime + Time(std::llround(static_cast<long double>((at - moment).count()) * static_cast<long double>(rate)));
}

const ShowClock::Stretch& ShowClock::at(Time moment) const {
    const auto next = std::ranges::upper_bound(stretches_, moment, {}, &Stretch::moment);
    return next == stretches_.begin() ? *next : *std::prev(next);
}

Time ShowClock::showTime(Time moment) const { return at(moment).showTimeAt(moment); }

double ShowClock::rateAt(Time moment) const { return at(moment).rate; }

std::optional<Time> ShowClock::momentOf(Time showTime, Time since) const {
    for (auto stretch = stretches_.begin(); stretch != stretches_.end(); ++stretch) {
        const auto next = std::next(stretch);
        const Time from = stretch == stretches_.begin() ? since : std::max(since, stretch->moment);
        if (next != stretches_.end() && next->moment <= from) continue;
        const Time begin = stretch->showTimeAt(from);
        if (begin == showTime) return from;
        if (begin > showTime || stretch->rate == 0) continue;
        const auto length = static_cast<long double>((showTime - begin).count()) / static_cast<long double>(stretch->rate);
        const Time reached = from + Time(std::llround(std::ceil(length)));
        if (next == stretches_.end() || reached < next->moment) return reached;
    }
    return std::nullopt;
}

void ShowClock::change(Time moment, Time showTime, double rate) {
    FANTASCOPE_CHECK(moment >= stretches_.back().moment, "a clock is changed in the order of time");
    if (stretches_.back().moment == moment) stretches_.pop_back();
    stretches_.push_back({moment, showTime, rate});
}

void ShowClock::pause(Time moment) { change(moment, showTime(moment), 0); }

void ShowClock::resume(Time moment) { change(moment, showTime(moment), rate_); }

void ShowClock::seek(Time moment, Time showTime) { change(moment, showTime, rateAt(moment)); }

void ShowClock::setRate(Time moment, double rate) {
    FANTASCOPE_CHECK(rate > 0, "a show goes forward");
    rate_ = rate;
    if (rateAt(moment) > 0) change(moment, showTime(moment), rate);
}

}  // namespace fantascope::show
