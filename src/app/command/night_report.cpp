#include "app/command/night_report.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

// The value of a key; null if there is none.
const Report& valueOf(const Report& object, const std::string& key) {
    static const Report kNull;
    const auto found = object.find(key);
    return found == object.end() ? kNull : *found;
}

std::optional<double> numberOf(const Report& value) {
    return value.is_null() ? std::nullopt : std::optional(value.get<double>());
}

std::string textOf(const Report& value) { return value.is_null() ? "" : value.get<std::string>(); }

// A report writes a number that is not finite as null; such a point is left out.
std::vector<glm::dvec2> scoresOf(const Report& series) {
    std::vector<glm::dvec2> scores;
    for (const Report& entry : series) {
        const auto at = numberOf(entry.at(0)), score = numberOf(entry.at(1));
        if (at && score) scores.emplace_back(*at, *score);
    }
    return scores;
}

std::vector<plot::Night::Sight> sightsOf(const Report& series) {
    std::vector<plot::Night::Sight> sights;
    for (const Report& entry : series) {
        const auto at = numberOf(valueOf(entry, "at")), drift = numberOf(valueOf(entry, "drift_px"));
        if (!at || !drift) continue;
        sights.push_back(
            {*at, *drift, numberOf(valueOf(entry, "sigma_px")).value_or(0), numberOf(valueOf(entry, "moved_px")).value_or(0)});
    }
    return sights;
}

std::vector<plot::Night::OtherLight> otherLightOf(const Report& series) {
    std::vector<plot::Night::OtherLight> lights;
    for (const Report& entry : series) {
        const auto at = numberOf(valueOf(entry, "at")), excess = numberOf(valueOf(entry, "excess"));
        if (at && excess)
            lights.push_back(
                {*at, *excess, numberOf(valueOf(entry, "ambient")).value_or(0), numberOf(valueOf(entry, "share")).value_or(1)});
    }
    return lights;
}

// Patterns that were fitted to their wall, and relays that a trim held off.
std::vector<plot::Night::Action> actionsOf(const Report& report) {
    std::vector<plot::Night::Action> actions;
    for (const Report& pattern : valueOf(report, "patterns")) {
        const double at = pattern.at("at").get<double>();
        if (pattern.at("applied").get<bool>())
            actions.push_back({pattern.at("source").get<std::string>() + ": the pattern was fitted to the wall", at, at});
    }
    bool isOff = false;
    for (const Report& lamps : valueOf(report, "lamps")) {
        const double at = lamps.at("at").get<double>();
        const bool wasOff = std::exchange(isOff, lamps.at("relays_off").get<int>() > 0);
        if (isOff && !wasOff) actions.push_back({"relays were switched off for ambient light", at, {}});
        if (!isOff && wasOff) actions.back().to = at;
    }
    return actions;
}

// The outputs that the camera has seen, or that something was wrong with.
std::vector<plot::Night::Output> outputsOf(const Report& report, const std::vector<plot::Night::Cause>& causes) {
    std::vector<plot::Night::Output> outputs;
    const auto outputNamed = [&](const std::string& name) -> plot::Night::Output& {
        const auto found = std::find_if(outputs.begin(), outputs.end(), [&](const auto& output) { return output.name == name; });
        return found != outputs.end() ? *found : outputs.emplace_back(plot::Night::Output{name});
    };
    for (const auto& [name, series] : valueOf(report, "z_camera").items()) outputNamed(name).z = scoresOf(series);
    for (const auto& [name, series] : valueOf(report, "tone_camera").items()) outputNamed(name).tone = scoresOf(series);
    for (const auto& [name, series] : valueOf(report, "iou_camera").items()) outputNamed(name).iou = scoresOf(series);
    for (const auto& [name, series] : valueOf(report, "watch").items()) outputNamed(name).sights = sightsOf(series);
    for (const plot::Night::Cause& cause : causes)
        if (!cause.output.empty()) outputNamed(cause.output);
    std::erase_if(outputs, [&](const plot::Night::Output& output) {
        const auto concerns = [&](const plot::Night::Cause& cause) { return cause.output == output.name; };
        return output.z.empty() && output.tone.empty() && output.iou.empty() && output.sights.empty() &&
               std::none_of(causes.begin(), causes.end(), concerns);
    });
    return outputs;
}

plot::Night readNight(const Report& report) {
    plot::Night night;
    night.seconds = numberOf(valueOf(report, "seconds")).value_or(0);
    night.frames = valueOf(report, "frames").is_null() ? 0 : report.at("frames").get<std::int64_t>();
    night.lateFrames = valueOf(report, "late_frames").is_null() ? 0 : report.at("late_frames").get<std::int64_t>();
    for (const Report& cause : valueOf(report, "causes"))
        night.causes.push_back({textOf(valueOf(cause, "output")), cause.at("cause").get<std::string>(),
                                cause.at("from").get<double>(), numberOf(valueOf(cause, "to"))});
    for (const Report& fault : valueOf(report, "faults"))
        night.faults.push_back({textOf(valueOf(fault, "device")), fault.at("what").get<std::string>(),
                                fault.at("at").get<double>(), numberOf(valueOf(fault, "until"))});
    for (const Report& cue : valueOf(report, "cues"))
        if (!cue.contains("list"))  // of the show's own cues
            night.cues.push_back({cue.at("name").get<std::string>(), cue.at("entered").get<double>()});
    night.otherLight = otherLightOf(valueOf(report, "lamps"));
    night.actions = actionsOf(report);
    night.outputs = outputsOf(report, night.causes);
    return night;
}

}  // namespace

bool isNight(const Report& report) { return report.is_object() && report.contains("cues") && report.contains("faults"); }

std::optional<plot::Night> nightOf(const Report& report) {
    try {
        return readNight(report);
    } catch (const nlohmann::json::exception&) {  // a key is missing or has another type
        return std::nullopt;
    }
}

}  // namespace fantascope::app
