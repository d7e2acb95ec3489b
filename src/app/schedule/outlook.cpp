#include "app/schedule/outlook.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <utility>

namespace fantascope::app {

namespace {

using show::Nights;

constexpr Time kDay = std::chrono::hours(24);

std::string nameOf(const Nights::Moment& moment, const show::Show& show) {
    return moment.cue < 0 ? "dark" : show.cues[static_cast<std::size_t>(moment.cue)].name;
}

}  // namespace

std::string dayAndClockOf(const WallTime& time) {
    return fmt::format("{}, {}", show::textOf(time.date), show::clockOf(time.timeOfDay));
}

std::string wordsOf(const Nights::Moment& moment, const show::Revision& revision) {
    const std::string name = nameOf(moment, revision.show);
    return fmt::format("{} since {}", moment.cue < 0 ? name : "'" + name + "'",
                       show::clockOf(revision.nights->zone().at(moment.utc).timeOfDay));
}

std::string nextOf(const show::Revision& revision, Time utc) {
    const Nights& nights = *revision.nights;
    const auto next = nights.after(utc);
    if (!next) return "";
    const WallTime when = nights.zone().at(next->utc);
    return fmt::format("{} {}", next->utc - utc < kDay ? show::clockOf(when.timeOfDay) : dayAndClockOf(when),
                       nameOf(*next, revision.show));
}

const std::string& Outlook::at(Time utc) {
    const show::Revision& revision = show_.newest();
    if (std::exchange(revision_, &revision) == &revision && utc >= from_ && utc < until_) return text_;
    const auto next = revision.nights ? revision.nights->after(utc) : std::nullopt;
    text_ = revision.nights ? nextOf(revision, utc) : "";
    from_ = utc;
    until_ = !next ? utc + kDay : next->utc - utc < kDay ? next->utc : next->utc - kDay;
    return text_;
}

std::string nextDayOf(const show::Revision& revision, Time utc) {
    const Nights& nights = *revision.nights;
    const show::Show& show = revision.show;
    const WallTime now = nights.zone().at(utc);
    std::string text = fmt::format("{} in {}: {}", dayAndClockOf(now), nights.zone().name(), nameOf(nights.at(utc), show));
    const auto moments = nights.between(utc, utc + kDay);
    for (const Nights::Moment& moment : moments)
        text += fmt::format("\n{}  {}", show::clockOf(nights.zone().at(moment.utc).timeOfDay), nameOf(moment, show));
    if (!moments.empty()) return text;
    const std::string next = nextOf(revision, utc);
    return text + (next.empty() ? "\nnothing within a year" : "\nnothing within 24 hours; then " + next);
}

}  // namespace fantascope::app
