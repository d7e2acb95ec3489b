#include "app/schedule/season_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <optional>
#include <vector>

namespace fantascope::app {

namespace {

using show::Nights;

// A cue that the schedule enters, and when the next one comes or it gets dark.
struct Stretch {
    Time from{}, until{};  // UTC
    std::string cue;
};
std::vector<Stretch> stretchesOf(const Nights::Night& night, const show::Show& show) {
    std::vector<Stretch> stretches;
    for (std::size_t i = 0; i + 1 < night.moments.size(); ++i)
        if (const int cue = night.moments[i].cue; cue >= 0)
            stretches.push_back({night.moments[i].utc, night.moments[i + 1].utc, show.cues[static_cast<std::size_t>(cue)].name});
    return stretches;
}

// "21:15"; "-": there is no such moment.
std::string clockAt(const std::optional<Time>& utc, const Nights& nights) {
    return utc ? show::clockOf(nights.zone().at(*utc).timeOfDay) : "-";
}

template <class Use>
void eachNight(const Season& season, Use use) {
    for (int i = 0; i < season.count; ++i)
        use(season.nights.night(show::Date(std::chrono::sys_days(season.first) + std::chrono::days(i))));
}

}  // namespace

std::string tableOf(const Season& season) {
    std::string table = fmt::format("{:<16} {:>6}  {:>5}  {:>5}  {}\n", "night", "sunset", "from", "until", "cue");
    eachNight(season, [&](const Nights::Night& night) {
        std::string lead = fmt::format("{:<16} {:>6}", show::textOf(night.date), clockAt(night.sunset, season.nights));
        const std::string remarks = fmt::format("{}", fmt::join(night.remarks, ", "));
        const auto stretches = stretchesOf(night, season.show);
        if (stretches.empty())
            table += fmt::format("{}  {:>5}  {:>5}  {}\n", lead, "-", "-", remarks.empty() ? "nothing" : remarks);
        for (const Stretch& stretch : stretches) {
            const bool isFirst = &stretch == stretches.data();
            table += fmt::format("{}  {}  {}  {}{}\n", lead, clockAt(stretch.from, season.nights),
                                 clockAt(stretch.until, season.nights), stretch.cue,
                                 isFirst && !remarks.empty() ? " (" + remarks + ")" : "");
            lead.assign(lead.size(), ' ');
        }
    });
    return table;
}

Report jsonOf(const Season& season) {
    Report json;
    json["time_zone"] = std::string(season.nights.zone().name());
    json["nights"] = Report::array();
    eachNight(season, [&](const Nights::Night& night) {
        const auto seconds = [](const std::optional<Time>& utc) {
            return utc ? Report(std::chrono::floor<std::chrono::seconds>(*utc).count()) : Report();
        };
        Report cues = Report::array();
        for (const Stretch& stretch : stretchesOf(night, season.show))
            cues.push_back({{"cue", stretch.cue}, {"from", seconds(stretch.from)}, {"until", seconds(stretch.until)}});
        json["nights"].push_back(
            {{"date", fmt::format("{:04}-{:02}-{:02}", static_cast<int>(night.date.year()),
                                  static_cast<unsigned>(night.date.month()), static_cast<unsigned>(night.date.day()))},
             {"sunset", seconds(night.sunset)},
             {"sunrise", seconds(night.sunrise)},
             {"cues", cues},
             {"remarks", night.remarks}});
    });
    return json;
}

}  // namespace fantascope::app
