#include "app/base/report.h"
#include "app/command/commands.h"
#include "app/schedule/outlook.h"
#include "app/schedule/season_table.h"
#include "app/site/site_file.h"

#include "show/revision.h"

#include "core/wall_clock.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <string>

namespace fantascope::app {
namespace {

struct Options {
    std::string show, site, from;
    int days = 30;
    std::filesystem::path report;
};

void declare(Command& command, Options& options) {
    command.add("show", options.show, "a show's folder").required();
    command.add("--site", options.site, "the site: a folder or a site.yaml").required();
    command.add("--from", options.from, "the first night, like 2026-12-24 (default: the present one)");
    command.add("--days", options.days, "how many nights").range(1, 1000).showDefault();
    command.add("--report", options.report, "write the nights to this JSON file (docs/report.md)");
}

Result<void> schedule(const Options& options) {
    show::Show show = TRY(show::Show::load(options.show));
    if (!show.schedule) return Error(fmt::format("{}: this show has no schedule: it {}", show.file.string(), show.beginning()));
    const auto revision = TRY(show::Revision::of(std::move(show), TRY(readSite(options.site))));
    const show::Nights& nights = *revision->nights;
    const Time now = SystemWallClock().now().utc;
    const show::Date first = options.from.empty() ? nights.nightAt(now) : TRY(show::dateOf(options.from).in("--from"));
    const Season season{revision->show, nights, first, options.days};
    fmt::print("{}\n{}\n", tableOf(season), nextDayOf(*revision, now));
    if (!options.report.empty()) TRY(writeReport(options.report, jsonOf(season)));
    return {};
}

}  // namespace

void addScheduleCommand(Program& program) {
    addCommand<Options>(program, "schedule", "Print what a show's schedule plays on which nights", declare, schedule);
}

}  // namespace fantascope::app
