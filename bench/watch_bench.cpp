// Measures what the watch of the wall makes of nights in simulation that a seed draws: which faults
// it names, whether it names or moves anything where nothing is wrong, and how it brings pictures
// back, and the lamps of the site.

#include "app/watch/drawn_night.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

namespace fantascope::app {
namespace {

std::string wordsOf(const std::vector<CauseReport>& causes) {
    std::string words;
    for (const CauseReport& cause : causes) {
        words += fmt::format(" {}{}{} {:.1f}-", cause.output, cause.output.empty() ? "" : ": ", cause.cause, seconds(cause.from));
        words += cause.to ? fmt::format("{:.1f};", seconds(*cause.to)) : ";";
    }
    return words;
}

// One fault a night. Right: its cause is named, for the right output, and nothing else is.
void playFaults(NightOptions options, const std::string& kind, std::uint64_t first, std::uint64_t last) {
    std::map<std::string, std::pair<int, int>> counts;  // by kind: right, drawn
    for (options.seed = first; options.seed <= last; ++options.seed) {
        const auto isIt = [&](const DrawnFault& fault) { return fault.kind == kind; };
        const DrawnFault& fault =
            kind.empty() ? drawnFaults()[options.seed % drawnFaults().size()] : *std::ranges::find_if(drawnFaults(), isIt);
        options.fault = fault.kind;
        const NightResult night = playNight(options);
        const bool isNamed = std::ranges::any_of(night.causes, [&](const CauseReport& cause) {
            return cause.cause == fault.cause && (!fault.ofOutput || cause.output == night.output);
        });
        const bool isRight = isNamed && night.causes.size() == 1;
        for (auto* count : {&counts[fault.kind], &counts["all"]}) {
            count->first += isRight ? 1 : 0;
            ++count->second;
        }
        fmt::print("{} {:4} {} |{}\n",
                   isRight   ? "right"
                   : isNamed ? "more "
                             : "WRONG",
                   options.seed, night.drawn, wordsOf(night.causes));
        std::fflush(stdout);
    }
    for (const auto& [name, count] : counts) fmt::print("{:12} {} of {}\n", name, count.first, count.second);
}

// Nights without a fault. Right: nothing is named, and nothing moves.
void playQuiet(NightOptions options, std::uint64_t first, std::uint64_t last) {
    for (options.seed = first; options.seed <= last; ++options.seed) {
        const NightResult night = playNight(options);
        double farthest = 0;
        for (const auto& [output, moved] : night.farthest) farthest = std::max(farthest, moved);
        fmt::print("{:4} {} outputs, {:.0f} s: moved by {:.2f} px at most |{}\n", options.seed, night.outputs.size(),
                   options.length, farthest, wordsOf(night.causes));
        std::fflush(stdout);
    }
}

// Projectors that are pushed, and brought back.
void playDrift(NightOptions options, std::uint64_t first, std::uint64_t last) {
    options.fault = "bump";
    for (options.seed = first; options.seed <= last; ++options.seed) {
        const NightResult night = playNight(options);
        double moved = 0, at = 0, found = -1, after15 = 0, most = 0, others = 0;
        for (const Placed& placed : night.placed) {
            if (moved == 0 && placed.moved > 0) at = seconds(placed.at);
            moved = std::max(moved, placed.moved);
            if (found < 0 && moved > 0 && placed.shifted > 0) found = seconds(placed.at) - at;
            most = std::max(most, placed.shifted);
            if (moved > 0 && seconds(placed.at) <= at + 15) after15 = placed.missed;
        }
        for (const auto& [output, far] : night.farthest) others = output == night.output ? others : std::max(others, far);
        fmt::print(
            "{:4} {}: {:5.2f} px, corrected after {:.1f} s, {:.2f} px rms after 15 s, at most {:.0f} % of it; others moved "
            "{:.2f} |{}\n",
            options.seed, night.output, moved, found, after15, 100 * most / moved, others, wordsOf(night.causes));
        std::fflush(stdout);
    }
}

// How much light the lamps take away beyond the rise at most, once a cue is not new any more.
double overshootOf(const NightResult& night, double from, double to) {
    constexpr double kNew = 10;  // seconds
    double most = 0, asked = -1, changed = 0;
    auto report = night.otherLight.begin();
    for (const LampMoment& moment : night.lamps) {
        const double at = seconds(moment.at);
        if (moment.asked != std::exchange(asked, moment.asked)) changed = at;
        for (; report != night.otherLight.end() && report->at <= moment.at; ++report)
            if (at >= from && at < to && at - changed > kNew) most = std::max(most, -report->excess);
    }
    return most;
}

// A window that lights up, and is dark again: how the lamps answer. `first` .. `last`: the seeds.
void playLamps(NightOptions options, std::uint64_t first, std::uint64_t last) {
    constexpr double kLasts = 70;  // seconds
    options.lamps = "automatic";
    options.fault = "ambient";
    options.faultAt = 20;
    options.faultLasts = kLasts;
    options.length = 145;
    for (options.seed = first; options.seed <= last; ++options.seed) {
        const NightResult night = playNight(options);
        const double from = night.faultAt, to = from + kLasts;
        // By what was given of what the cues asked, and by what the watch measured.
        double end = 1, settled = 0, back = -1, before = 1, ambient = 0, rest = 0;
        int counted = 0;
        const auto shareOf = [](const LampMoment& moment) { return moment.asked > 0 ? moment.given / moment.asked : 1; };
        for (const LampMoment& moment : night.lamps) {
            const double at = seconds(moment.at), share = shareOf(moment);
            if (at < from) before = std::min(before, share);
            if (at < to) end = share;
            if (at >= to && share < 0.999) back = at - to;
        }
        for (const LampMoment& moment : night.lamps)
            if (seconds(moment.at) >= from && seconds(moment.at) < to && shareOf(moment) > end + 0.1 * (1 - end))
                settled = seconds(moment.at) - from;
        for (const LampReport& report : night.otherLight)
            if (seconds(report.at) > to - 20 && seconds(report.at) < to) {
                ambient += report.ambient, rest += report.excess;
                ++counted;
            }
        ambient /= std::max(1, counted), rest /= std::max(1, counted);
        fmt::print(
            "{:4} latency {:.2f}: +{:.1f} % of full light, share {:.2f}, overshoot {:.2f} %, 90 % after {:.1f} s, left {:+.1f} "
            "%, "
            "moved before {:.2f}, back after {:.1f} s, relay {} |{}\n",
            options.seed, options.latency, 100 * ambient, end, 100 * overshootOf(night, from, to), settled, 100 * rest,
            1 - before, back,
            std::ranges::all_of(night.lamps, [](const LampMoment& moment) { return moment.isLampOn; }) ? "on" : "off",
            wordsOf(night.causes));
        std::fflush(stdout);
    }
}

}  // namespace
}  // namespace fantascope::app

int main(int argc, char** argv) {
    CLI::App app("Measures the watch of the wall on drawn nights");
    fantascope::app::NightOptions options;
    std::uint64_t first = 1, last = 14;
    std::string what = "faults", kind;
    bool isPlan = false;
    app.add_option("what", what, "faults, quiet, drift or lamps")->check(CLI::IsMember({"faults", "quiet", "drift", "lamps"}));
    app.add_option("--first", first, "first seed");
    app.add_option("--last", last, "last seed");
    app.add_option("--kind", kind, "only faults of this kind, as in a site file (default: each in turn)");
    app.add_option("--length", options.length, "seconds of a night");
    app.add_option("--latency", options.latency, "of the camera, seconds");
    app.add_option("--camera-width", options.camera.x, "of the camera's pictures, pixels");
    app.add_option("--camera-rate", options.cameraRate, "of the camera, Hz");
    app.add_option("--frame-delay", options.frameDelay, "until the watch gets a frame that is visible, seconds");
    app.add_flag("--plan", isPlan, "the sites were not calibrated");
    app.add_flag("--busy", options.isBusy, "headlights pass, and thin fog comes and goes");
    CLI11_PARSE(app, argc, argv);
    if (const auto& all = fantascope::app::drawnFaults();
        !kind.empty() && std::ranges::find(all, kind, &fantascope::app::DrawnFault::kind) == all.end())
        return fmt::print(stderr, "watch_bench: there are no faults of the kind '{}'\n", kind), 1;
    options.isSurveyed = !isPlan;
    options.camera.y = options.camera.x * 9 / 16;
    if (what == "quiet" || what == "drift") options.geometry = "automatic";
    if (what == "faults") fantascope::app::playFaults(options, kind, first, last);
    if (what == "quiet") fantascope::app::playQuiet(options, first, last);
    if (what == "drift") fantascope::app::playDrift(options, first, last);
    if (what == "lamps") fantascope::app::playLamps(options, first, last);
}
