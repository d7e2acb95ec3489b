#include "app/live/run_console.h"

#include "app/keys/run_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <utility>

namespace fantascope::app {
namespace {

constexpr int kShortName = 16;  // columns
constexpr int kAnyWidth = std::numeric_limits<int>::max();
constexpr const char* kBetween = "  ";
constexpr Time kRedraw = std::chrono::milliseconds(100), kRepeat = std::chrono::minutes(1);

// The parts of the line from left to right. Each has several forms, from the longest to the
// shortest. An empty form takes no room.
namespace line {
enum Part {
    Panic,
    Blackout,
    SettingUp,
    Frozen,
    Paused,
    Master,
    Highlight,
    Parked,
    ByHand,
    Locked,
    Cue,
    Fade,
    Loaded,
    Next,
    Sides,
    Schedule,
    Left,
    Unwell,
    Late,
    Rate,
    Scores,
    kParts
};
}  // namespace line
using Forms = std::vector<std::string>;

// The parts to shorten by one form, in this order, while the line is too long.
constexpr line::Part kShortening[] = {
    line::Scores,    line::Rate,   line::Next,      line::Schedule, line::Sides,     line::Sides,  line::Next,   line::Cue,
    line::Cue,       line::Late,   line::Fade,      line::Left,     line::Next,      line::Next,   line::Loaded, line::Locked,
    line::Paused,    line::Frozen, line::SettingUp, line::Cue,      line::SettingUp, line::Loaded, line::Locked, line::Master,
    line::Paused,    line::Frozen, line::Sides,     line::Unwell,   line::Unwell,    line::ByHand, line::Parked, line::Highlight,
    line::Highlight, line::Panic,  line::Blackout,  line::Cue};

Forms cueForms(const RunStatus& status) {
    const int cue = status.controls.cue;
    if (cue < 0) return {"no cue yet", ""};
    const std::string number = fmt::format("{}/{}", cue + 1, status.cues);
    const std::string place = show::placeOf(status.number, cue, status.cues);
    return {fmt::format("cue {}: {}", place, status.cueName), number + " " + status.cueName,
            number + " " + fitted(status.cueName, kShortName), number, ""};
}

Forms nextForms(const RunStatus& status) {
    if (status.nextName.empty()) return {"last cue", ""};
    const std::string in = status.untilNext ? " in " + shortDuration(*status.untilNext) : "";
    const std::string note = status.nextNote.empty() ? "" : fmt::format(" ({})", status.nextNote);
    return {"next: " + status.nextName + in + note, "next: " + status.nextName + in,
            "next: " + fitted(status.nextName, kShortName) + in, in.empty() ? "" : "next" + in, ""};
}

Forms sideForms(const RunStatus& status) {
    Forms forms{"", "", "", ""};  // with what comes, without it, the list that has the keys, nothing
    for (const RunStatus::Side& side : status.sides) {
        const std::string name = side.hasKeys ? fmt::format("[{}]", side.name) : side.name;
        const std::string now = fmt::format("{}: {}", name, side.cueName.empty() ? "dark" : side.cueName);
        const std::string next =
            side.untilNext ? fmt::format(" > {} in {}", side.nextName, shortDuration(*side.untilNext)) : std::string();
        const auto add = [&](std::size_t form, const std::string& text) {
            forms[form] += (forms[form].empty() ? "" : kBetween) + text;
        };
        add(0, now + next);
        add(1, now);
        if (side.hasKeys) add(2, fmt::format("[{}]", fitted(side.name, kShortName)));
    }
    return forms;
}

std::string scoresOf(const RunStatus& status) {
    std::string text;
    for (const auto& [output, z] : status.zCamera)
        text += fmt::format("{}z {} {}", text.empty() ? "" : kBetween, output, z < 0 ? "-" : fmt::format("{:.3f}", z));
    return text;
}

std::array<Forms, line::kParts> partsOf(const RunStatus& status) {
    std::array<Forms, line::kParts> parts;
    const show::Controls& controls = status.controls;
    const auto tell = [&](line::Part part, bool on, std::string what, RunKey::Action by, const char* does) {
        if (!on) return;
        if (status.keys && (!status.settingUp || part == line::SettingUp))
            parts[part] = {fmt::format("{}, {} {} it", what, keyFor(by), does)};
        parts[part].push_back(std::move(what));
        if (part != line::Blackout && part != line::Panic) parts[part].push_back("");
    };
    tell(line::Panic, controls.panic, "PANIC", RunKey::Action::Restore, "restores");
    tell(line::Blackout, controls.blackout, "BLACKOUT", RunKey::Action::Blackout, "lifts");
    tell(line::SettingUp, status.settingUp, "SETTING UP", RunKey::Action::SetUp, "ends");
    tell(line::Frozen, controls.frozen, "FROZEN", RunKey::Action::Freeze, "ends");
    tell(line::Paused, controls.paused, "PAUSED", RunKey::Action::Pause, "ends");
    tell(line::Locked, controls.locked, "LOCKED", RunKey::Action::Lock, "unlocks");
    const std::string level =
        controls.highlightLevel < 1 ? fmt::format(" at {:.0f} %", 100 * controls.highlightLevel) : std::string();
    tell(line::Highlight, !status.highlighted.empty(), (controls.solo ? "SOLO " : "HIGHLIGHT ") + status.highlighted + level,
         controls.solo ? RunKey::Action::Solo : RunKey::Action::Highlight, controls.solo ? "ends" : "goes on from");
    if (!status.parked.empty()) parts[line::Parked] = {"parked: " + status.parked, ""};
    if (!status.byHand.empty()) parts[line::ByHand] = {"by hand: " + status.byHand, ""};
    if (controls.master < 1) parts[line::Master] = {fmt::format("master {:.0f} %", 100 * controls.master)};
    if (controls.master > 0) parts[line::Master].push_back("");
    if (!status.loadedName.empty())
        parts[line::Loaded] = {"GO: " + status.loadedName, "GO: " + fitted(status.loadedName, kShortName), ""};
    parts[line::Cue] = cueForms(status);
    if (status.waitLeft > Time{})
        parts[line::Fade] = {"waits " + shortDuration(status.waitLeft), ""};
    else if (status.fadeLeft > Time{})
        parts[line::Fade] = {"fading " + shortDuration(status.fadeLeft), ""};
    parts[line::Next] = nextForms(status);
    parts[line::Sides] = sideForms(status);
    parts[line::Schedule] = {status.schedule, ""};
    parts[line::Left] = {status.left ? shortDuration(*status.left) + " left" : "at " + shortDuration(status.showTime), ""};
    if (!status.unwell.empty()) parts[line::Unwell] = {"NOT WELL: " + status.unwell, "NOT WELL", ""};
    parts[line::Late] = {fmt::format("{} late", status.lateFrames), ""};
    if (status.framesPerSecond) parts[line::Rate] = {fmt::format("{:.1f} frames/s", *status.framesPerSecond), ""};
    parts[line::Scores] = {scoresOf(status), ""};
    return parts;
}

}  // namespace

std::string statusLine(const RunStatus& status, int columns) {
    const std::array<Forms, line::kParts> parts = partsOf(status);
    std::array<std::size_t, line::kParts> form{};
    const auto line = [&] {
        std::string text;
        for (std::size_t part = 0; part < line::kParts; ++part)
            if (form[part] < parts[part].size() && !parts[part][form[part]].empty())
                text += (text.empty() ? "" : kBetween) + parts[part][form[part]];
        return text;
    };
    std::string text = line();
    for (const line::Part part : kShortening) {
        if (columnsOf(text) <= columns) break;
        if (form[part] + 1 < parts[part].size()) ++form[part];
        text = line();
    }
    return fitted(text, columns);
}

std::string summaryOf(const RunReport& report) {
    std::int64_t frames = 0, late = 0, byMachine = 0;
    for (const OutputReport& output : report.outputs) {
        frames += output.frames;
        late += output.lateFrames();
        byMachine += output.lateByMachine;
    }
    std::string text = fmt::format("{:.1f} s, {} cue{} entered, ", seconds(report.length), report.cues.size(),
                                   report.cues.size() == 1 ? "" : "s");
    if (frames == 0) return text + "no frame shown";
    text += fmt::format("{} frames shown, ", frames);
    if (late == 0) return text + "none late";
    text += fmt::format("{} late: {}", late, lateFramesByCause(report.outputs));
    if (byMachine > 0 && report.yardstickLate > 0)
        text += fmt::format("; the machine was too busy even for a thread that does nothing, {} times in {}",
                            report.yardstickLate, report.yardstickTicks);
    return text;
}

RunConsole::RunConsole(const Clock& clock, std::ostream& out, std::function<int()> columns) : clock_(clock), out_(out) {
    if (columns) line_.emplace(out, std::move(columns));
}

void RunConsole::tell(const RunStatus& status) {
    std::string_view said = status.said;
    for (bool isFirst = true; !said.empty(); isFirst = false) {
        const std::size_t end = std::min(said.find('\n'), said.size());
        const std::string start = isFirst ? fmt::format("{:6.1f} s  ", seconds(status.showTime)) : std::string(10, ' ');
        const std::string news = fitted(start + std::string(said.substr(0, end)), kAnyWidth);
        if (line_)
            line_->say(news);
        else
            out_ << news << std::endl;
        said.remove_prefix(std::min(end + 1, said.size()));
    }
    const Time now = clock_.now();
    const bool due = !told_ || now - *told_ >= (line_ ? kRedraw : kRepeat) || (line_ && !status.said.empty());
    if (!due) return;
    told_ = now;
    if (line_)
        line_->draw(statusLine(status, line_->columns()));
    else
        out_ << fmt::format("{:6.1f} s  {}", seconds(status.showTime), statusLine(status, kAnyWidth)) << std::endl;
}

}  // namespace fantascope::app
