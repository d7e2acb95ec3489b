#include "app/live/run_report.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::app {
namespace {

constexpr std::array<const char*, kFrameParts> kPartNames = {"upload", "render", "swap"};
constexpr const char* kMachine = "machine";

Report jsonOf(const Durations& durations) {
    return {{"count", durations.count()},
            {"p50", durations.quantileMs(0.5)},
            {"p99", durations.quantileMs(0.99)},
            {"max", durations.maxMs()}};
}

// The cues and the faults of the run.
void addCues(Report& json, const RunReport& report) {
    json["resumed"] = nullptr;
    if (report.resumed) json["resumed"] = {{"cue", report.resumed->name}, {"at", seconds(report.resumed->entered)}};
    json["cues"] = Report::array();
    for (const CueReport& cue : report.cues) {
        json["cues"].push_back({{"name", cue.name}, {"entered", seconds(cue.entered)}});
        if (!cue.list.empty()) json["cues"].back()["list"] = cue.list;
    }
    json["faults"] = Report::array();
    for (const FaultReport& fault : report.faults) {
        Report entry = {{"at", seconds(fault.at)}, {"what", fault.what}};
        if (!fault.device.empty()) entry["device"] = fault.device;
        if (fault.until) entry["until"] = seconds(*fault.until);
        json["faults"].push_back(std::move(entry));
    }
}

void addWatch(Report& json, const RunReport& report) {
    json["watch"] = Report::object();
    for (const auto& [output, series] : report.watch) {
        json["watch"][output] = Report::array();
        for (const DriftReport& drift : series) {
            Report entry = {
                {"at", seconds(drift.at)}, {"drift_px", drift.drift}, {"sigma_px", drift.sigma}, {"moved_px", drift.corrected}};
            if (drift.corrected > 0)
                for (const glm::vec2 corner : drift.shift) entry["moved_corners"].push_back({corner.x, corner.y});
            json["watch"][output].push_back(std::move(entry));
        }
    }
    json["causes"] = Report::array();
    for (const CauseReport& cause : report.causes)
        json["causes"].push_back({{"output", cause.output},
                                  {"from", seconds(cause.from)},
                                  {"to", seconds(cause.to.value_or(report.length))},
                                  {"cause", cause.cause}});
}

void addLamps(Report& json, const RunReport& report) {
    json["lamps"] = Report::array();
    for (const LampReport& lamps : report.lamps)
        json["lamps"].push_back({{"at", seconds(lamps.at)},
                                 {"excess", lamps.excess},
                                 {"ambient", lamps.ambient},
                                 {"share", lamps.trim.share},
                                 {"relays_off", lamps.trim.relaysOff}});
}

Report jsonOf(const std::map<std::string, std::vector<std::pair<Time, double>>>& byOutput) {
    Report json = Report::object();
    for (const auto& [output, series] : byOutput) {
        json[output] = Report::array();
        for (const auto& [time, value] : series) json[output].push_back({seconds(time), value});
    }
    return json;
}

Report jsonOf(const std::vector<show::event::LightCorrected>& light) {
    Report json = Report::object();
    for (const show::event::LightCorrected& one : light) {
        Report& canvas = json[one.canvas];
        canvas["applied"] = one.applied && one.trouble.empty();
        if (one.trouble.empty())
            canvas.update({{"kept", one.kept}, {"too_dark", one.tooDark}, {"too_bright", one.tooBright}});
        else
            canvas["trouble"] = one.trouble;
    }
    return json;
}

Report jsonOf(const PatternNews& patterns) {
    Report json = Report::array();
    for (const auto& [at, fitted] : patterns)
        json.push_back({{"source", fitted.source},
                        {"at", seconds(at)},
                        {"applied", fitted.applied},
                        {"tone_before", fitted.toneBefore},
                        {"tone_after", fitted.toneAfter},
                        {"kept", fitted.kept},
                        {"made", fitted.made},
                        {"removed", fitted.removed},
                        {"changed", fitted.changed}});
    return json;
}

}  // namespace

std::optional<FramePart> causeOfDelay(const PartTimes& spent, Time period) {
    if (std::accumulate(spent.begin(), spent.end(), Time{}) <= period) return std::nullopt;
    return static_cast<FramePart>(std::max_element(spent.begin(), spent.end()) - spent.begin());
}

std::string lateFramesByCause(const std::vector<OutputReport>& outputs) {
    std::string text;
    const auto add = [&](const char* cause, auto countOf) {
        std::int64_t late = 0;
        for (const OutputReport& output : outputs) late += countOf(output);
        if (late > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", late, cause);
    };
    for (std::size_t part = 0; part < kFrameParts; ++part)
        add(kPartNames[part], [&](const OutputReport& output) { return output.lateBy[part]; });
    add(kMachine, [](const OutputReport& output) { return output.lateByMachine; });
    return text;
}

void addEvents(const show::EventLog& events, RunReport& report) {
    show::EventLog::Reader reader = events.reader();
    while (const show::Event* const event = reader.next()) {
        if (const auto* const entered = std::get_if<show::event::CueEntered>(&event->what))
            report.cues.push_back({entered->name, event->at, entered->list});
        else if (const auto* const decided = std::get_if<show::event::InputDecided>(&event->what)) {
            ++report.inputsBySource[std::string(show::nameOf(decided->input.input.source))];
            ++report.inputsByOutcome[std::string(show::nameOf(decided->input.outcome))];
        } else if (const auto* const resumed = std::get_if<show::event::ShowResumed>(&event->what))
            report.resumed = CueReport{resumed->cue, event->at};
        else if (const auto* const corrected = std::get_if<show::event::LightCorrected>(&event->what))
            report.light.push_back(*corrected);
        else if (const auto* const fitted = std::get_if<show::event::PatternFitted>(&event->what))
            report.patterns.emplace_back(event->at, *fitted);
    }
}

void addHappenings(const std::vector<site::Happening>& happenings, const show::ShowClock& showClock, RunReport& report) {
    for (const site::Happening& happening : happenings)
        report.faults.push_back({showClock.showTime(showClock.runStart() + happening.at), happening.text});
    std::ranges::stable_sort(report.faults, {}, &FaultReport::at);
}

std::string sentenceOf(const std::vector<UnsafeBank>& unsafe) {
    std::string banks;
    for (const auto& [bank, why] : unsafe) banks += fmt::format("{}'{}' ({})", banks.empty() ? "" : ", ", bank, why);
    return fmt::format("RELAYS MAY BE UNSAFE: {} did not confirm the safe states. Switch them at the module", banks);
}

std::string sentenceOf(const UnendedLine& line) {
    return fmt::format("the lamps of universe {} did not get their end levels ({}). Check on site", line.universe, line.why);
}

std::string hungSentence(const std::string& why, const std::vector<UnsafeBank>& unsafe, const std::vector<UnendedLine>& unended,
                         bool recordingIsLost) {
    std::string words = fmt::format("the show was to end, but {}. Its lamps and relays were closed first: {}", why,
                                    unsafe.empty() ? "all relays are safe" : sentenceOf(unsafe));
    for (const UnendedLine& line : unended) words += "; " + sentenceOf(line);
    if (recordingIsLost) words += ". The recording was not finished and is lost";
    return words;
}

Report jsonOf(const RunReport& report) {
    Report json, frameMs = Report::object(), late = Report::object(), lateBy = Report::object(), framesBy = Report::object();
    for (const OutputReport& output : report.outputs) {
        framesBy[output.name] = output.frames;
        late[output.name] = output.lateFrames();
        for (std::size_t part = 0; part < kFrameParts; ++part) {
            lateBy[output.name][kPartNames[part]] = output.lateBy[part];
            frameMs[output.name][kPartNames[part]] = jsonOf(output.took[part]);
        }
        lateBy[output.name][kMachine] = output.lateByMachine;
        if (!output.recorded) continue;
        json["recorded"][output.name] = *output.recorded;
        json["not_recorded"][output.name] = output.frames - *output.recorded;
    }
    for (const auto& [output, frames] : report.lostFrames) {
        json["recorded"][output] = 0;
        json["not_recorded"][output] = frames;
    }
    json["seconds"] = seconds(report.length);
    json["seed"] = report.seed;
    json["stop_reason"] = report.stopReason;
    if (!report.hung.empty()) json["hung"] = report.hung;
    json["unsafe_relays"] = Report::array();
    for (const auto& [bank, why] : report.unsafe) json["unsafe_relays"].push_back({{"bank", bank}, {"why", why}});
    json["frames"] = report.frames;
    json["late_frames"] = report.lateFrames;
    json["frames_by_output"] = framesBy;
    json["late_frames_by_output"] = late;
    json["late_frames_by_cause"] = lateBy;
    json["yardstick"] = {{"ticks", report.yardstickTicks}, {"late", report.yardstickLate}};
    json["frame_ms"] = frameMs;
    json["swap_skew_ms"] = jsonOf(report.swapSkew);
    json["late_video_frames"] = Report(report.lateVideoFrames);
    json["damaged_video_frames"] = Report(report.damagedVideoFrames);
    json["input_to_frame_ms"] = jsonOf(report.inputToFrame);
    if (report.startToFrame) json["start_to_frame_ms"] = 1000 * seconds(*report.startToFrame);
    json["dmx_interval_ms"] = jsonOf(report.dmxInterval);
    json["inputs"] = {{"by_source", report.inputsBySource}, {"by_outcome", report.inputsByOutcome}};
    addCues(json, report);
    json["light_correction"] = jsonOf(report.light);
    json["patterns"] = jsonOf(report.patterns);
    json["z_camera"] = jsonOf(report.zCamera);
    json["tone_camera"] = jsonOf(report.toneCamera);
    json["iou_camera"] = jsonOf(report.iouCamera);
    addWatch(json, report);
    addLamps(json, report);
    return json;
}

}  // namespace fantascope::app
