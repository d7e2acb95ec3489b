#include "app/journal/night.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string_view>

namespace fantascope::app {

namespace {

constexpr double kWidth = 1000, kLeft = 90, kRow = 18;  // of the picture of a night, in its units

constexpr std::string_view kHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>The night</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body { font: 15px/1.45 system-ui, sans-serif; color: #1d2430; max-width: 70rem; margin: 2rem auto; padding: 0 1rem; }
h1, h2, h3 { line-height: 1.2; } h2 { margin-top: 3rem; border-top: 1px solid #ccd3dd; padding-top: 1.5rem; }
table { border-collapse: collapse; margin: 1rem 0; } th, td { text-align: left; padding: .2rem 1rem .2rem 0; vertical-align: top; }
th { border-bottom: 1px solid #ccd3dd; font-weight: 600; } td.n { text-align: right; font-variant-numeric: tabular-nums; }
td.t { white-space: nowrap; font-variant-numeric: tabular-nums; color: #55617a; }
svg { width: 100%; height: auto; font: 11px system-ui, sans-serif; } .bad { color: #b3261e; font-weight: 600; }
details { margin: 1rem 0; } summary { cursor: pointer; }
</style></head><body>
)";

std::string escaped(std::string_view text) {
    std::string safe;
    for (const char letter : text) {
        if (letter == '&')
            safe += "&amp;";
        else if (letter == '<')
            safe += "&lt;";
        else if (letter == '>')
            safe += "&gt;";
        else if (letter == '"')
            safe += "&quot;";
        else
            safe += letter;
    }
    return safe;
}

std::string clockOf(const WallTime& time) {
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(time.timeOfDay).count();
    return fmt::format("{:02}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}
std::string dateOf(const WallTime& time) {
    return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(time.date.year()), static_cast<unsigned>(time.date.month()),
                       static_cast<unsigned>(time.date.day()));
}
std::string lengthOf(Time time) {
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(time).count();
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}
// Neighbouring numbers have colours that are far from each other.
std::string colourOf(std::size_t number) { return fmt::format("hsl({} 45% 72%)", number * 137 % 360); }

// The picture of a night over time.
class Timeline {
public:
    explicit Timeline(const Night& night) : night_(night), length_(std::max(seconds(night.length()), 1.0)) {}
    std::string svg() {
        axis();
        std::set<std::string> names;
        for (const Night::Stretch& cue : night_.cues) names.insert(cue.what);
        row("cues");
        for (const Night::Stretch& cue : night_.cues)
            bar(cue, colourOf(static_cast<std::size_t>(std::distance(names.begin(), names.find(cue.what)))), true);
        std::set<std::string> holds;
        for (const Night::Stretch& hold : night_.holds) holds.insert(hold.what);
        for (const std::string& name : holds) {
            row(name);
            for (const Night::Stretch& hold : night_.holds)
                if (hold.what == name) bar(hold, name == "panic" ? "#b3261e" : "#55617a", false);
        }
        row("pressed");
        for (const Night::Press& press : night_.presses)
            add(R"(<line x1="{0:.1f}" x2="{0:.1f}" y1="{1}" y2="{2}" stroke="#1d2430"><title>{3}</title></line>)", x(press.at),
                y_ + 2, y_ + kRow - 3,
                escaped(fmt::format("{} {} by {}", clockOf(night_.wallTimeOf(press.at)), press.what, press.by)));
        graph("late frames", night_.lateFrames, "#b3261e");
        for (const auto& [output, scores] : night_.z) graph("z " + output, scores, "#2a5db0");
        for (std::size_t i = 0; i + 1 < night_.runs.size(); ++i)
            if (night_.runs[i].ended.empty())
                add(R"(<line x1="{0:.1f}" x2="{0:.1f}" y1="16" y2="{1}" stroke="#b3261e" stroke-dasharray="3 2"><title>died</title></line>)",
                    x(night_.runs[i].to), y_ + kRow);
        return fmt::format(R"(<svg viewBox="0 0 {} {}" role="img" aria-label="the night over time">{}</svg>)", kWidth + 10,
                           y_ + kRow + 8, drawn_);
    }

private:
    template <class... Arguments>
    void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
        fmt::format_to(std::back_inserter(drawn_), format, std::forward<Arguments>(arguments)...);
    }
    double x(Time time) const { return kLeft + (kWidth - kLeft) * seconds(time) / length_; }
    void axis() {
        const double steps[] = {1, 5, 10, 30, 60, 300, 600, 1800, 3600, 7200, 21600};
        const double* step =
            std::find_if(std::begin(steps), std::end(steps) - 1, [&](double one) { return length_ / one <= 10; });
        for (double at = 0; at <= length_; at += *step) {
            const Time time = fromSeconds(at);
            const std::string clock = clockOf(night_.wallTimeOf(time));
            add(R"(<text x="{:.1f}" y="11" fill="#55617a">{}</text>)", x(time), *step < 60 ? clock : clock.substr(0, 5));
        }
    }
    void row(const std::string& name) {
        y_ += y_ == 0 ? kRow : kRow + 2;
        add(R"(<text x="0" y="{:.1f}">{}</text>)", y_ + 13, escaped(name.substr(0, 14)));
    }
    void bar(const Night::Stretch& stretch, const std::string& colour, bool named) {
        const double from = x(stretch.from), width = std::max(1.0, x(stretch.to) - from);
        add(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{}" fill="{}"><title>{}</title></rect>)", from, y_, width,
            kRow - 2, colour,
            escaped(fmt::format("{} {} for {}", clockOf(night_.wallTimeOf(stretch.from)), stretch.what,
                                lengthOf(stretch.to - stretch.from))));
        constexpr double kLetter = 6.5;
        if (named && width > kLetter * static_cast<double>(stretch.what.size()))
            add(R"(<text x="{:.1f}" y="{:.1f}">{}</text>)", from + 3, y_ + 12, escaped(stretch.what));
    }
    template <class Value>
    void graph(const std::string& name, const std::vector<std::pair<Time, Value>>& values, const char* colour) {
        if (values.empty()) return;
        row(name);
        double most = 0;
        for (const auto& [at, value] : values) most = std::max(most, static_cast<double>(value));
        std::string points;
        for (const auto& [at, value] : values)
            points +=
                fmt::format("{:.1f},{:.1f} ", x(at), y_ + (kRow - 3) * (1 - (most > 0 ? static_cast<double>(value) / most : 0)));
        add(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="1.2"/>)", points, colour);
        add(R"(<text x="{}" y="{:.1f}" text-anchor="end" fill="#55617a">up to {:.3g}</text>)", kWidth, y_ + 10, most);
    }

    const Night& night_;
    const double length_;  // seconds
    double y_ = 0;
    std::string drawn_;
};

std::string bad(std::size_t count) { return count == 0 ? "0" : fmt::format(R"(<span class="bad">{}</span>)", count); }

std::string tableOf(const std::vector<std::pair<std::string, Night>>& nights) {
    std::string text =
        "<table><tr><th>night</th><th>began</th><th>length</th><th>runs</th><th>died</th><th>cues</th><th>pressed</th>"
        "<th>corrections</th><th>frames</th><th>late</th><th>lines lost</th></tr>\n";
    for (std::size_t i = 0; i < nights.size(); ++i) {
        const Night& night = nights[i].second;
        const WallTime began = night.wallTimeOf(Time{});
        text += fmt::format(
            R"(<tr><td><a href="#night{}">{}</a></td><td class="t">{}</td><td class="n">{}</td><td class="n">{}</td><td class="n">{}</td>)"
            R"(<td class="n">{}</td><td class="n">{}</td><td class="n">{}</td><td class="n">{}</td><td class="n">{}</td><td class="n">{}</td></tr>)"
            "\n",
            i + 1, dateOf(began), clockOf(began), lengthOf(night.length()), night.runs.size(), bad(night.deaths()),
            night.cues.size(), night.presses.size(), night.corrections, night.frames, night.late,
            bad(night.damaged + night.gaps));
    }
    return text + "</table>\n";
}

std::string sectionOf(const Night& night, const std::string& file, std::size_t number) {
    const WallTime began = night.wallTimeOf(Time{});
    std::string text = fmt::format("<h2 id=\"night{}\">{}, {}</h2>\n<p>{} &middot; {}</p>\n{}\n", number, dateOf(began),
                                   clockOf(began), escaped(night.show), escaped(file), Timeline(night).svg());
    text += "<h3>Runs</h3><table><tr><th>from</th><th>length</th><th>began</th><th>ended</th></tr>\n";
    for (const Night::Run& run : night.runs)
        text +=
            fmt::format(R"(<tr><td class="t">{}</td><td class="n">{}</td><td>{}</td><td>{}</td></tr>)"
                        "\n",
                        clockOf(localTimeOf(run.utc)), lengthOf(run.to - run.from), run.goesOn ? "went on" : "from the beginning",
                        !run.ended.empty()           ? escaped(run.ended)
                        : &run == &night.runs.back() ? "not yet, or it died"
                                                     : R"(<span class="bad">it died</span>)");
    text += "</table>\n<h3>Who pressed what</h3><table><tr><th>when</th><th>what</th><th>by</th></tr>\n";
    for (const Night::Press& press : night.presses)
        text += fmt::format(R"(<tr><td class="t">{}</td><td>{}</td><td>{}</td></tr>)"
                            "\n",
                            clockOf(night.wallTimeOf(press.at)), escaped(press.what), escaped(press.by));
    text += fmt::format("</table>\n<details{}><summary>Everything that was told ({})</summary><table>\n",
                        night.events.size() <= 200 ? " open" : "", night.events.size());
    for (const show::journal::Told& told : night.events)
        text += fmt::format(R"(<tr><td class="t">{}</td><td>{}</td></tr>)"
                            "\n",
                            clockOf(night.wallTimeOf(told.at)), escaped(told.text));
    return text + "</table></details>\n";
}

}  // namespace

std::string pageOf(const std::vector<std::pair<std::string, Night>>& nights) {
    std::string page(kHead);
    page += nights.size() == 1 ? "<h1>The night</h1>\n" : fmt::format("<h1>{} nights</h1>\n", nights.size());
    page += tableOf(nights);
    for (std::size_t i = 0; i < nights.size(); ++i) page += sectionOf(nights[i].second, nights[i].first, i + 1);
    return page + "</body></html>\n";
}

}  // namespace fantascope::app
