#include "plot/night_figure.h"

#include "plot/chart.h"
#include "plot/palette.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <utility>

namespace fantascope::plot {
namespace {

constexpr double kNightText = 12, kNightLeft = 80, kNightRight = 1170;  // points, as all sizes
constexpr int kNightWidth = 1200, kNightColumns = 1090;                 // the charts are one column per point wide
constexpr double kNightHeader = 74, kCueNames = 18, kPanelTitle = 26, kPanelHeight = 170, kPanelGap = 8, kTimeAxis = 46;
constexpr double kRowHeight = 32;
constexpr std::size_t kMostRows = 16;
constexpr double kLeastBar = 3;
constexpr glm::dvec3 kOfAllOutputs{0.25, 0.25, 0.25}, kAction{0.35, 0.55, 0.3};
constexpr Stroke kCueLine{{0.45, 0.45, 0.45}, 0.8, 0.7};

// The time axis of all charts of a night.
struct NightTime {
    double unit = 1;  // seconds
    Axis axis;

    double of(double seconds) const { return seconds / unit; }
    double perPoint() const { return (axis.to - axis.from) / kNightColumns; }
    double onPage(double seconds) const {
        return kNightLeft + (of(seconds) - axis.from) / (axis.to - axis.from) * (kNightRight - kNightLeft);
    }
};

NightTime timeOf(const Night& night) {
    constexpr double kMinute = 60, kHour = 3600;
    double end = night.seconds;
    for (const Night::Output& output : night.outputs) {
        for (const auto& series : {output.z, output.tone, output.iou})
            if (!series.empty()) end = std::max(end, series.back().x);
        if (!output.sights.empty()) end = std::max(end, output.sights.back().at);
    }
    if (!night.otherLight.empty()) end = std::max(end, night.otherLight.back().at);
    if (end <= 0) end = 1;
    if (end > 3 * kHour) return {kHour, {0, end / kHour, "show time, h"}};
    if (end > 5 * kMinute) return {kMinute, {0, end / kMinute, "show time, min"}};
    return {1, {0, end, "show time, s"}};
}

// One chart of the page.
struct NightPanel {
    std::string title;
    double height = kPanelHeight;
    Axis y;
    std::function<void(Chart&)> draw;
};

// The series without its gaps: an output that is dark has no score, and a line across that time
// would invent one. A gap is much longer than the time between most points, and can be seen.
std::vector<std::span<const glm::dvec2>> withoutGaps(std::span<const glm::dvec2> points, const NightTime& time) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < points.size(); ++i) steps.push_back(points[i].x - points[i - 1].x);
    double gap = 2 * time.perPoint();
    if (!steps.empty()) {
        std::vector<double> sorted = steps;
        const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
        std::nth_element(sorted.begin(), middle, sorted.end());
        gap = std::max(gap, 5 * *middle);
    }
    std::vector<std::span<const glm::dvec2>> pieces;
    for (std::size_t first = 0, end = 1; first < points.size(); first = end, ++end) {
        while (end < points.size() && steps[end - 1] <= gap) ++end;
        pieces.push_back(points.subspan(first, end - first));
    }
    return pieces;
}

void drawSeries(Chart& chart, std::span<const glm::dvec2> points, const NightTime& time, const Stroke& stroke) {
    for (const auto piece : withoutGaps(points, time)) {
        chart.line(thinned(piece, time.axis.from, time.axis.to, kNightColumns), stroke);
        if (piece.size() == 1) chart.discs(piece, stroke.width, stroke.colour);
    }
}

// A score of the camera, by output. `of`: its series.
std::optional<NightPanel> scorePanel(const Night& night, const NightTime& time, std::string title, std::string label,
                                     std::vector<glm::dvec2> Night::Output::*of) {
    std::vector<double> values;
    std::vector<std::vector<glm::dvec2>> lines;
    for (const Night::Output& output : night.outputs) {
        lines.emplace_back();
        for (const glm::dvec2 score : output.*of) {
            lines.back().emplace_back(time.of(score.x), score.y);
            values.push_back(score.y);
        }
    }
    if (values.empty()) return std::nullopt;
    return NightPanel{std::move(title), kPanelHeight, axisAround(values, std::move(label)),
                      [lines = std::move(lines), time](Chart& chart) {
                          for (std::size_t i = 0; i < lines.size(); ++i) drawSeries(chart, lines[i], time, {actorColour(i), 1.2});
                      }};
}

struct DriftLines {
    std::vector<glm::dvec2> drift, low, high, moved;
};

void drawDrift(Chart& chart, const DriftLines& lines, const NightTime& time, glm::dvec3 colour) {
    const auto lows = withoutGaps(lines.low, time), highs = withoutGaps(lines.high, time);
    for (std::size_t i = 0; i < lows.size(); ++i) {
        std::vector<glm::dvec2> band = thinned(lows[i], time.axis.from, time.axis.to, kNightColumns);
        const auto back = thinned(highs[i], time.axis.from, time.axis.to, kNightColumns);
        band.insert(band.end(), back.rbegin(), back.rend());
        chart.area(band, colour, 0.25);
    }
    drawSeries(chart, lines.drift, time, {colour, 1.4});
    // A picture that was never moved needs no dashes along the axis.
    if (std::any_of(lines.moved.begin(), lines.moved.end(), [](glm::dvec2 at) { return at.y > 0; }))
        drawSeries(chart, lines.moved, time, {0.55 * colour, 1.4, 1, true});  // darker, to be seen before the drift
}

std::optional<NightPanel> driftPanel(const Night& night, const NightTime& time) {
    std::vector<double> values;
    std::vector<DriftLines> outputs;
    for (const Night::Output& output : night.outputs) {
        DriftLines lines;
        for (const Night::Sight& sight : output.sights) {
            const double at = time.of(sight.at), low = std::max(0.0, sight.drift - sight.sigma), high = sight.drift + sight.sigma;
            lines.drift.emplace_back(at, sight.drift);
            lines.low.emplace_back(at, low);
            lines.high.emplace_back(at, high);
            lines.moved.emplace_back(at, sight.moved);
            values.insert(values.end(), {high, sight.moved});
        }
        outputs.push_back(std::move(lines));
    }
    if (values.empty()) return std::nullopt;
    return NightPanel{
        "drift of the pictures on the wall; band: standard deviation; dashed: how far the program moves a picture back",
        kPanelHeight, axisAround(values, "projector pixels"), [outputs = std::move(outputs), time](Chart& chart) {
            for (std::size_t i = 0; i < outputs.size(); ++i) drawDrift(chart, outputs[i], time, actorColour(i));
        }};
}

using Lines = std::vector<std::vector<glm::dvec2>>;

// Of something that concerns all outputs; the lines after the first are dashed.
NightPanel panelOfAll(std::string title, Axis y, Lines lines, const NightTime& time) {
    return {std::move(title), kPanelHeight, std::move(y), [lines = std::move(lines), time](Chart& chart) {
                for (std::size_t i = lines.size(); i-- > 0;) drawSeries(chart, lines[i], time, {kOfAllOutputs, 1.4, 1, i > 0});
            }};
}

std::vector<NightPanel> lightPanels(const Night& night, const NightTime& time) {
    if (night.otherLight.empty()) return {};
    Lines lights(2), shares(1);
    std::vector<double> values;
    for (const Night::OtherLight& light : night.otherLight) {
        lights[0].emplace_back(time.of(light.at), 100 * light.excess);
        lights[1].emplace_back(time.of(light.at), 100 * light.ambient);
        shares[0].emplace_back(time.of(light.at), 100 * light.share);
        values.insert(values.end(), {lights[0].back().y, lights[1].back().y});
    }
    return {panelOfAll("other light on the pictures, beside the usual; dashed: the ambient light that has come",
                       axisAround(values, "% of full light"), std::move(lights), time),
            panelOfAll("what is left of the lamps' levels", {0, 105, "%"}, std::move(shares), time)};
}

// A line of the strip: all bars of a cause and an output, of an action, or of a device.
struct NightRow {
    std::string key, label;
    glm::dvec3 colour;
    std::vector<std::pair<double, double>> bars{};  // from, to; seconds
};

NightRow& rowOf(std::vector<NightRow>& rows, NightRow row) {
    const auto same = [&](const NightRow& other) { return other.key == row.key; };
    const auto found = std::find_if(rows.begin(), rows.end(), same);
    return found != rows.end() ? *found : rows.emplace_back(std::move(row));
}

std::vector<NightRow> rowsOf(const Night& night) {
    std::vector<NightRow> rows;
    const double end = night.seconds;
    for (const Night::Cause& cause : night.causes) {
        const auto named = [&](const Night::Output& output) { return output.name == cause.output; };
        const auto output = std::find_if(night.outputs.begin(), night.outputs.end(), named);
        const glm::dvec3 colour =
            output == night.outputs.end() ? kOfAllOutputs : actorColour(static_cast<std::size_t>(output - night.outputs.begin()));
        const std::string label = cause.output.empty() ? cause.what : fmt::format("{}: {}", cause.output, cause.what);
        rowOf(rows, {"cause " + label, label, colour}).bars.emplace_back(cause.from, cause.to.value_or(end));
    }
    for (const Night::Action& action : night.actions)
        rowOf(rows, {"action " + action.what, "done: " + action.what, kAction})
            .bars.emplace_back(action.from, action.to.value_or(end));
    constexpr std::size_t kFaultColour = 6;  // vermilion
    for (const Night::Fault& fault : night.faults) {
        const std::string label = fault.device.empty() ? fault.what : fmt::format("{}: {}", fault.device, fault.what);
        NightRow& row = rowOf(
            rows, {"fault " + (fault.device.empty() ? fault.what : fault.device), "fault: " + label, actorColour(kFaultColour)});
        if (row.label != "fault: " + label && !row.label.ends_with("; and others")) row.label += "; and others";
        row.bars.emplace_back(fault.from, fault.to.value_or(end));
    }
    if (rows.size() > kMostRows) {
        const std::size_t more = rows.size() - kMostRows + 1;
        rows.resize(kMostRows - 1);
        rows.push_back({"", fmt::format("{} more such rows are not drawn; the report lists all faults", more), {}});
    }
    return rows;
}

NightPanel stripPanel(const Page& page, std::vector<NightRow> rows, const NightTime& time, bool isScored) {
    if (rows.empty()) rows.push_back({"", isScored ? "nothing was out of place, and nothing failed" : "nothing failed", {}});
    for (NightRow& row : rows) row.label = page.shortened(row.label, kNightText, kNightColumns - kNightText);
    const auto count = static_cast<double>(rows.size());
    const Axis y{0, count, "", false, Axis::Marks::None};
    return {"what was wrong, and what was done", count * kRowHeight, y, [rows = std::move(rows), time, count](Chart& chart) {
                const double least = kLeastBar * time.perPoint();
                for (std::size_t i = 0; i < rows.size(); ++i) {
                    const double bottom = count - 1 - static_cast<double>(i);
                    chart.note(rows[i].label, {time.axis.from, bottom + 0.7});
                    for (const auto& [from, to] : rows[i].bars) {
                        // A fault of the last moment, too, has a bar that can be seen.
                        const double left = std::min(time.of(from), time.axis.to - least);
                        chart.box({left, bottom + 0.12}, {std::max(time.of(to), left + least), bottom + 0.42}, rows[i].colour);
                    }
                }
            }};
}

void drawHeader(Page& page, const Night& night, bool isScored) {
    const auto whole = static_cast<long>(std::lround(night.seconds));
    const std::string length = night.seconds < 300 ? fmt::format("{:.4g} s", night.seconds)
                               : whole < 3600      ? fmt::format("{} min {} s", whole / 60, whole % 60)
                                                   : fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
    page.text(fmt::format("A run of {}: {} frames, {} late{}", length, night.frames,
                          night.lateFrames == 0 ? "none" : fmt::format("{}", night.lateFrames),
                          isScored ? "" : "; no camera has seen its pictures"),
              {kNightLeft, 26}, kNightText + 4, Anchor::Left);
    const double share = (kNightRight - kNightLeft) / std::max<double>(1, static_cast<double>(night.outputs.size()));
    double x = kNightLeft;
    for (std::size_t i = 0; i < night.outputs.size(); ++i) {
        const std::string name = page.shortened(night.outputs[i].name, kNightText, share - 60);
        page.line({x, 54}, {x + 24, 54}, {actorColour(i), 3});
        page.text(name, {x + 30, 54}, kNightText, Anchor::Left);
        x += 54 + page.textWidth(name, kNightText);
    }
}

// Names of cues, each where it does not cover the one before.
void nameCues(Page& page, const Night& night, const NightTime& time, double y) {
    double taken = kNightLeft - kNightText;
    for (const Night::Cue& cue : night.cues) {
        const double at = time.onPage(cue.entered), end = at + page.textWidth(cue.name, kNightText - 1);
        if (at < taken + kNightText / 2 || end > kNightWidth) continue;
        page.text(cue.name, {at, y}, kNightText - 1, Anchor::Left);
        taken = end;
    }
}

// Many lines would hide the charts, so many cues have short marks at the upper edge.
void drawCues(Chart& chart, const Night& night, const NightTime& time, const NightPanel& panel) {
    constexpr std::size_t kMostLines = 40;
    constexpr double kMark = 8;
    const double share = night.cues.size() > kMostLines ? kMark / panel.height : 1;
    const double low = panel.y.to - share * (panel.y.to - panel.y.from);
    for (const Night::Cue& cue : night.cues)
        chart.line(std::vector<glm::dvec2>{{time.of(cue.entered), low}, {time.of(cue.entered), panel.y.to}}, kCueLine);
}

}  // namespace

Page nightFigure(const Night& night) {
    const NightTime time = timeOf(night);
    std::vector<NightPanel> panels;
    const auto add = [&](std::optional<NightPanel> panel) {
        if (panel) panels.push_back(std::move(*panel));
    };
    add(scorePanel(night, time, "z of the camera: 0 is the guide drawing", "z", &Night::Output::z));
    add(scorePanel(night, time, "tone of the camera: 0 is the drawing's light", "tone", &Night::Output::tone));
    add(scorePanel(night, time, "IoU of the camera: 1 is the shadow's target", "IoU", &Night::Output::iou));
    add(driftPanel(night, time));
    for (NightPanel& panel : lightPanels(night, time)) panels.push_back(std::move(panel));
    const bool isScored = !panels.empty();
    panels.push_back(stripPanel(Page(1, 1), rowsOf(night), time, isScored));

    double height = kNightHeader + kCueNames + kTimeAxis;
    for (const NightPanel& panel : panels) height += kPanelTitle + panel.height + kPanelGap;
    Page page(kNightWidth, static_cast<int>(height));
    drawHeader(page, night, isScored);
    double top = kNightHeader;
    for (const NightPanel& panel : panels) {
        const bool isFirst = &panel == &panels.front(), isLast = &panel == &panels.back();
        page.text(panel.title, {kNightLeft, top + kPanelTitle / 2}, kNightText + 1, Anchor::Left);
        top += kPanelTitle;
        if (isFirst) {
            nameCues(page, night, time, top + kCueNames / 2);
            top += kCueNames;
        }
        Axis x = time.axis;
        if (!isLast) x.label = "", x.marks = Axis::Marks::Lines;
        Chart chart(page, {kNightLeft, top}, {kNightRight, top + panel.height}, x, panel.y);
        drawCues(chart, night, time, panel);
        panel.draw(chart);
        top += panel.height + kPanelGap;
    }
    return page;
}

}  // namespace fantascope::plot
