#include "pattern/motion_section.h"

#include <fmt/format.h>

namespace fantascope::pattern {
namespace {

// What an axis moves: both `magnitude` and `range` are lengths in canvas heights, or angles.
enum class Kind { Length, Angle };

struct Axis {
    const char* key;
    AxisMotion MotionSettings::*motion;
    Kind kind;
};
constexpr Axis kAxes[] = {
    {"group_major", &MotionSettings::groupMajor, Kind::Length},
    {"group_minor", &MotionSettings::groupMinor, Kind::Length},
    {"local_translation", &MotionSettings::localTranslation, Kind::Length},
    {"local_tilt", &MotionSettings::localTilt, Kind::Angle},
    {"local_turn", &MotionSettings::localTurn, Kind::Angle},
};

Result<AxisMotion> readAxis(const ConfigNode& node, AxisMotion axis, Kind kind) {
    ConfigFields fields(node);
    fields.optional().number("beta", axis.beta, 0, 4);
    fields.optional().number("natural_frequency", axis.naturalFrequency, 0.001, 15, "Hz");
    fields.optional().number("damping", axis.damping, 0.001, 0.999);
    for (const auto& [key, target] : {std::pair("magnitude", &axis.magnitude), std::pair("range", &axis.range)}) {
        if (kind == Kind::Angle)
            fields.optional().angle(key, *target, 0, 360);
        else
            fields.optional().number(key, *target, 0, 10, "canvas heights");
    }
    TRY(fields.finish());
    return axis;
}

}  // namespace

Result<MotionSettings> readMotion(const ConfigNode& node) {
    MotionSettings motion;
    ConfigFields fields(node);
    fields.optional().read("frames", motion.frames, [](const ConfigNode& value) -> Result<int> {
        const auto frames = static_cast<int>(TRY(value.integer(4, 100'000)));
        if (frames % 2 != 0) return value.error(fmt::format("{} is odd; the number of frames must be even", frames));
        return frames;
    });
    fields.optional().number("rate", motion.rate, 1, 1000, "Hz");
    fields.optional().number("deviation", motion.deviation, 0, 1);
    fields.optional().angle("direction", motion.direction, -360, 360);
    fields.optional().number("instances_per_group", motion.instancesPerGroup, 1, 1e6);
    fields.optional().number("fuzziness", motion.fuzziness, 1.01, 10);
    for (const Axis& axis : kAxes) {
        AxisMotion& target = motion.*axis.motion;
        fields.optional().read(axis.key, target, [&](const ConfigNode& value) { return readAxis(value, target, axis.kind); });
    }
    TRY(fields.finish());
    return motion;
}

std::string motionSection(const MotionSettings& motion) {
    std::string text = "motion:\n";
    text += fmt::format("  frames: {}\n  rate: {}\n  deviation: {}\n", motion.frames, shortest(motion.rate),
                        shortest(motion.deviation));
    text += fmt::format("  direction: {}\n", shortestDegrees(motion.direction));
    text += fmt::format("  instances_per_group: {}\n  fuzziness: {}\n", shortest(motion.instancesPerGroup),
                        shortest(motion.fuzziness));
    for (const Axis& axis : kAxes) {
        const AxisMotion& m = motion.*axis.motion;
        const auto movement = axis.kind == Kind::Angle ? shortestDegrees : shortest;
        text += fmt::format("  {}: {{beta: {}, natural_frequency: {}, damping: {}, magnitude: {}, range: {}}}\n", axis.key,
                            shortest(m.beta), shortest(m.naturalFrequency), shortest(m.damping), movement(m.magnitude),
                            movement(m.range));
    }
    return text;
}

}  // namespace fantascope::pattern
