#include "pattern/shape/motion_file.h"

#include <fmt/format.h>

#include <iterator>

namespace fantascope::pattern {
namespace {

struct AxisKey {
    const char* key;
    AxisMotion MotionSettings::*axis;
    bool turns;  // about an axis, in radians; else along it, in canvas heights
};
constexpr AxisKey kAxisKeys[] = {
    {"group_major", &MotionSettings::groupMajor, false},
    {"group_minor", &MotionSettings::groupMinor, false},
    {"local_translation", &MotionSettings::localTranslation, false},
    {"local_tilt", &MotionSettings::localTilt, true},
    {"local_turn", &MotionSettings::localTurn, true},
};

Result<int> readFrames(const ConfigNode& node) {
    const std::int64_t frames =
        TRY(node.integer(4, 20'000));  // 40 bytes per frame and instance: 20,000 frames of 3000 instances take 2.4 GB
    if (frames % 2 != 0) return node.error(fmt::format("{} is odd, must be even", frames));
    return static_cast<int>(frames);
}

// `axis`: the defaults.
Result<AxisMotion> readAxis(const ConfigNode& node, AxisMotion axis, bool turns) {
    ConfigFields fields(node);
    fields.optional().number("beta", axis.beta, 0, 10);
    fields.optional().number("natural_frequency", axis.naturalFrequency, 0.01, 100, "Hz");
    fields.optional().number("damping", axis.damping, 0.001, 0.999);
    if (turns) {
        fields.optional().angle("magnitude", axis.magnitude, 0, 3600);
        fields.optional().angle("range", axis.range, 0, 360);
    } else {
        fields.optional().number("magnitude", axis.magnitude, 0, 10, "canvas heights");
        fields.optional().number("range", axis.range, 0, 1, "canvas heights");
    }
    TRY(fields.finish());
    return axis;
}

std::string axisText(const AxisMotion& axis, bool turns) {
    const auto amount = [&](double value) { return turns ? shortestDegrees(value) : shortest(value); };
    return fmt::format("{{beta: {}, natural_frequency: {}, damping: {}, magnitude: {}, range: {}}}", shortest(axis.beta),
                       shortest(axis.naturalFrequency), shortest(axis.damping), amount(axis.magnitude), amount(axis.range));
}

}  // namespace

Result<MotionSettings> readMotion(const ConfigNode& node) {
    MotionSettings motion;
    ConfigFields fields(node);
    fields.optional().read("frames", motion.frames, readFrames);
    fields.optional().number("rate", motion.rate, 1, 240, "Hz");
    fields.optional().number("deviation", motion.deviation, 0, 1);
    fields.optional().angle("direction", motion.direction, -360, 360);
    fields.optional().number("instances_per_group", motion.instancesPerGroup, 1, 100'000);
    fields.optional().number("fuzziness", motion.fuzziness, 1.01, 10);
    for (const auto& [key, axis, turns] : kAxisKeys) {
        AxisMotion& target = motion.*axis;
        fields.optional().read(key, target,
                               [&target, turns = turns](const ConfigNode& at) { return readAxis(at, target, turns); });
    }
    TRY(fields.finish());
    return motion;
}

Result<bool> setsAmplitude(const ConfigNode& node) {
    for (const auto& [key, value] : TRY(node.entries())) {
        if (!value.isMap()) continue;
        for (const auto& [ofAxis, number] : TRY(value.entries()))
            if (ofAxis == "magnitude" || ofAxis == "range") return true;
    }
    return false;
}

std::string motionText(const MotionSettings& motion) {
    std::string text = fmt::format(
        "motion:\n  frames: {}\n  rate: {}\n  deviation: {}\n  direction: {}\n  instances_per_group: {}\n  fuzziness: {}\n",
        motion.frames, shortest(motion.rate), shortest(motion.deviation), shortestDegrees(motion.direction),
        shortest(motion.instancesPerGroup), shortest(motion.fuzziness));
    for (const auto& [key, axis, turns] : kAxisKeys)
        fmt::format_to(std::back_inserter(text), "  {}: {}\n", key, axisText(motion.*axis, turns));
    return text;
}

}  // namespace fantascope::pattern
