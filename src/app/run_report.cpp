#include "app/run_report.h"

namespace fantascope::app {
namespace {

Report jsonOf(const Durations& durations) {
    return {{"count", durations.count()},
            {"p50", durations.quantileMs(0.5)},
            {"p99", durations.quantileMs(0.99)},
            {"max", durations.maxMs()}};
}

}  // namespace

Report jsonOf(const RunReport& report) {
    Report json, frameMs = Report::object(), lateBy = Report::object(), framesBy = Report::object();
    std::int64_t frames = 0, late = 0;
    for (const OutputReport& output : report.outputs) {
        frames += output.frames;
        late += output.lateFrames;
        framesBy[output.name] = output.frames;
        lateBy[output.name] = output.lateFrames;
        frameMs[output.name] = jsonOf(output.frame);
    }
    json["seconds"] = seconds(report.length);
    json["seed"] = report.seed;
    json["stop_reason"] = report.stopReason;
    json["frames"] = frames;
    json["late_frames"] = late;
    json["frames_by_output"] = framesBy;
    json["late_frames_by_output"] = lateBy;
    json["yardstick"] = {{"ticks", report.yardstickTicks}, {"late", report.yardstickLate}};
    json["frame_ms"] = frameMs;
    json["input_to_frame_ms"] = jsonOf(report.inputToFrame);
    json["dmx_interval_ms"] = jsonOf(report.dmxInterval);
    json["cues"] = Report::array();
    for (const CueReport& cue : report.cues) json["cues"].push_back({{"name", cue.name}, {"entered", seconds(cue.entered)}});
    json["faults"] = Report::array();
    for (const FaultReport& fault : report.faults) json["faults"].push_back({{"at", seconds(fault.at)}, {"what", fault.what}});
    json["z_camera"] = Report::object();
    for (const auto& [output, series] : report.zCamera) {
        json["z_camera"][output] = Report::array();
        for (const auto& [time, z] : series) json["z_camera"][output].push_back({seconds(time), z});
    }
    return json;
}

}  // namespace fantascope::app
