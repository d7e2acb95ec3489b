// Measures what the watch of the wall makes of drawn nights in simulation: faults named, and
// nothing named where nothing is wrong.

#include "app/watch/drawn_night.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <map>

namespace fantascope::app {
namespace {

void playFaults(NightOptions options, const std::string& kind, std::uint64_t first, std::uint64_t last) {
    std::map<std::string, std::pair<int, int>> counts;  // by kind: named, drawn
    for (options.seed = first; options.seed <= last; ++options.seed) {
        const DrawnFault& fault = drawnFaults()[options.seed % drawnFaults().size()];
        if (!kind.empty() && fault.kind != kind) continue;
        options.fault = fault.kind;
        const NightResult night = playNight(options);
        bool isNamed = false;
        std::string said;
        for (const CauseReport& cause : night.causes) {
            isNamed = isNamed || (cause.cause == fault.cause && (!fault.ofOutput || cause.output == night.output));
            said +=
                fmt::format(" {}{}{} {:.1f}", cause.output, cause.output.empty() ? "" : ": ", cause.cause, seconds(cause.from));
            said += cause.to ? fmt::format("-{:.1f};", seconds(*cause.to)) : ";";
        }
        const bool isRight = isNamed && night.causes.size() == 1;
        auto& [named, drawn] = counts[fault.kind];
        named += isRight ? 1 : 0;
        ++drawn;
        fmt::print("{} {:4} {} |{}\n", isRight ? "right" : isNamed ? "more " : "WRONG", options.seed, night.drawn, said);
        std::fflush(stdout);
    }
    int allNamed = 0, all = 0;
    for (const auto& [name, count] : counts) {
        fmt::print("{:12} {} of {}\n", name, count.first, count.second);
        allNamed += count.first;
        all += count.second;
    }
    fmt::print("all          {} of {}\n", allNamed, all);
}

}  // namespace
}  // namespace fantascope::app

int main(int argc, char** argv) {
    CLI::App app("Measures the watch of the wall");
    fantascope::app::NightOptions options;
    std::uint64_t first = 1, last = 14;
    std::string kind;
    bool isPlan = false;
    app.add_option("--first", first, "first seed");
    app.add_option("--last", last, "last seed");
    app.add_option("--kind", kind, "only faults of this kind");
    app.add_option("--length", options.length, "seconds");
    app.add_option("--at", options.faultAt, "when the fault happens at the earliest, seconds");
    app.add_flag("--plan", isPlan, "the site was not calibrated");
    CLI11_PARSE(app, argc, argv);
    options.isSurveyed = !isPlan;
    fantascope::app::playFaults(options, kind, first, last);
}
