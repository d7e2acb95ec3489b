#include "app/run_report.h"

#include <algorithm>
#include <cmath>

namespace fantascope::app {
namespace {

nlohmann::ordered_json jsonOf(const Quantiles& quantiles) {
    return {{"count", quantiles.count}, {"p50", quantiles.p50}, {"p99", quantiles.p99}, {"max", quantiles.max}};
}

}  // namespace

Quantiles quantilesOf(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const auto rank = [&](double share) { return values[static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size()))) - 1]; };
    return {values.size(), rank(0.5), rank(0.99), values.back()};
}

nlohmann::ordered_json jsonOf(const RunReport& report) {
    nlohmann::ordered_json json;
    json["seconds"] = seconds(report.length);
    json["seed"] = report.seed;
    json["stop_reason"] = report.stopReason;
    std::int64_t frames = 0, late = 0;
    nlohmann::ordered_json frameMs = nlohmann::ordered_json::object(), lateBy = frameMs, framesBy = frameMs;
    for (const OutputReport& output : report.outputs) {
        frames += output.frames;
        late += output.lateFrames;
        framesBy[output.name] = output.frames;
        lateBy[output.name] = output.lateFrames;
        frameMs[output.name] = jsonOf(quantilesOf(output.frameMs));
    }
    json["frames"] = frames;
    json["late_frames"] = late;
    json["frames_by_output"] = framesBy;
    json["late_frames_by_output"] = lateBy;
    json["frame_ms"] = frameMs;
    json["yardstick"] = {{"ticks", report.yardstickTicks}, {"late", report.yardstickLate}};
    json["input_to_frame_ms"] = jsonOf(quantilesOf(report.inputToFrameMs));
    json["dmx_interval_ms"] = jsonOf(quantilesOf(report.dmxIntervalMs));
    json["cues"] = nlohmann::ordered_json::array();
    for (const CueReport& cue : report.cues) json["cues"].push_back({{"name", cue.name}, {"entered", seconds(cue.entered)}});
    json["faults"] = nlohmann::ordered_json::array();
    for (const FaultReport& fault : report.faults) json["faults"].push_back({{"at", seconds(fault.at)}, {"what", fault.what}});
    json["z_camera"] = nlohmann::ordered_json::object();
    for (const auto& [output, series] : report.zCamera) {
        json["z_camera"][output] = nlohmann::ordered_json::array();
        for (const auto& [time, z] : series) json["z_camera"][output].push_back({seconds(time), z});
    }
    return json;
}

}  // namespace fantascope::app
