#include "theatre/deform/handle_motion.h"

#include "core/config/config.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kVersion = 1;
constexpr std::size_t kMostHandles = 100, kMostKeys = 10'000;
constexpr double kLeastSeconds = 0.01, kMostSeconds = 3600;
constexpr double kFarthest = 10;  // in shares of the picture

// The slope at a key: the weighted harmonic mean of the slopes of the adjacent intervals. 0 if they
// differ in sign, so that nothing overshoots.
double slopeAt(double before, double lengthBefore, double after, double lengthAfter) {
    if (before * after <= 0) return 0;
    const double a = 2 * lengthAfter + lengthBefore, b = lengthAfter + 2 * lengthBefore;
    return (a + b) / (a / before + b / after);
}

// The cubic Hermite polynomial over an interval of this length.
double eased(double from, double slopeFrom, double to, double slopeTo, double length, double share) {
    const double s = share, r = 1 - share;
    return r * r * (1 + 2 * s) * from + s * s * (1 + 2 * r) * to + length * s * r * (r * slopeFrom - s * slopeTo);
}

// Reads the handles. The size of the picture and the length of the motion are known by then.
class MotionReader {
public:
    MotionReader(const TriangulatedSilhouette& silhouette, const HandleMotion& motion)
        : silhouette_(silhouette), motion_(motion), size_(silhouette.width, silhouette.height) {}

    Result<HandleMotion::Handle> readHandle(const ConfigNode& node) {
        HandleMotion::Handle handle;
        ConfigFields own(node);
        own.read("name", handle.name, [&](const ConfigNode& at) -> Result<std::string> {
            const std::string name = TRY(at.text());
            for (const HandleMotion::Handle& other : handles_)
                if (other.name == name)
                    return at.error(fmt::format("two handles are called '{}'; give each a name of its own", name));
            return name;
        });
        own.read("at", handle.at, [&](const ConfigNode& at) { return readRest(at, handle.name); });
        own.optional().list(
            "keys", handle.keys,
            [&, last = -1.0](const ConfigNode& at) mutable -> Result<HandleMotion::Key> {
                const HandleMotion::Key key = TRY(readKey(at, handle, last));
                last = key.time;
                return key;
            },
            1, kMostKeys);
        TRY(own.finish());
        TRY(closeLoop(node, handle));
        handle.point = silhouette_.carried(handle.at);
        handles_.push_back(handle);
        return handle;
    }

private:
    Result<glm::dvec2> readRest(const ConfigNode& node, const std::string& handle) const {
        const glm::dvec2 share = TRY(node.vector2(-kFarthest, kFarthest)), place = share * size_;
        const glm::dvec2 nearest = silhouette_.nearest(place);
        if (const double away = glm::distance(nearest, place); away > kFarOutside) {
            const glm::dvec2 within = nearest / size_;
            return node.error(
                fmt::format("handle '{}' is {:.0f} pixels outside the white, and would hold nothing; the nearest point of the "
                            "white is [{:.3f}, {:.3f}]: both are shares of the picture, from 0 (left, top) to 1 (right, bottom)",
                            handle, away, within.x, within.y));
        }
        for (const HandleMotion::Handle& other : handles_)
            if (glm::distance(other.at, place) < kSamePoint)
                return node.error(
                    fmt::format("handles '{}' and '{}' are at the same point; take either away, or move it", other.name, handle));
        return place;
    }

    Result<HandleMotion::Key> readKey(const ConfigNode& node, const HandleMotion::Handle& handle, double last) const {
        HandleMotion::Key key;
        bool hasBy = false, hasTo = false;
        ConfigFields own(node);
        own.read("time", key.time, [&](const ConfigNode& at) -> Result<double> {
            const double time = TRY(at.number(0, kMostSeconds, "s"));
            if (time <= last)
                return at.error(
                    fmt::format("handle '{}': the key at {} s comes after the one at {} s; times rise from key to key",
                                handle.name, time, last));
            if (motion_.seconds > 0 && time > motion_.seconds)
                return at.error(
                    fmt::format("handle '{}': a key at {} s is after the end; make 'seconds' longer than {}, or move the key",
                                handle.name, time, motion_.seconds));
            return time;
        });
        const auto place = [&](bool& isGiven, glm::dvec2 from) {
            return [&isGiven, from, this](const ConfigNode& at) -> Result<glm::dvec2> {
                isGiven = true;
                return from + TRY(at.vector2(-kFarthest, kFarthest)) * size_;
            };
        };
        own.optional().read("by", key.place, place(hasBy, handle.at));
        own.optional().read("to", key.place, place(hasTo, glm::dvec2(0)));
        TRY(own.finish());
        if (hasBy == hasTo)
            return node.error(
                fmt::format("handle '{}': a key has either 'by: [right, down]', how far the handle is from where it "
                            "rests, or 'to: [across, down]', where it is",
                            handle.name));
        return key;
    }

    // In a loop, a key at the very end repeats the one at the beginning, so it is dropped.
    Result<void> closeLoop(const ConfigNode& node, HandleMotion::Handle& handle) const {
        auto& keys = handle.keys;
        if (!motion_.loops || keys.size() < 2 || keys.front().time > 0 || keys.back().time < motion_.seconds) return {};
        if (glm::distance(keys.front().place, keys.back().place) > 1e-6)
            return node.error(
                fmt::format("handle '{}': the motion loops, and its key at {} s, the end, is elsewhere than the one at 0 s: "
                            "leave the last key out, or make it the same",
                            handle.name, motion_.seconds));
        keys.pop_back();
        return {};
    }

    const TriangulatedSilhouette& silhouette_;
    const HandleMotion& motion_;
    const glm::dvec2 size_;
    std::vector<HandleMotion::Handle> handles_;  // read so far
};

}  // namespace

glm::dvec2 HandleMotion::placeAt(const Handle& handle, double time) const {
    const std::vector<Key>& keys = handle.keys;
    if (keys.empty()) return handle.at;
    if (keys.size() == 1) return keys[0].place;
    const auto count = static_cast<std::ptrdiff_t>(keys.size());
    // A loop's keys repeat periodically in both directions.
    const auto keyAt = [&](std::ptrdiff_t i) {
        const std::ptrdiff_t round = i < 0 ? -1 : i / count;
        Key key = keys[static_cast<std::size_t>(i - round * count)];
        key.time += static_cast<double>(round) * seconds;
        return key;
    };
    if (loops)
        time -= seconds * std::floor((time - keys[0].time) / seconds);
    else
        time = std::clamp(time, keys.front().time, keys.back().time);
    std::ptrdiff_t i = 0;
    while (i + (loops ? 1 : 2) < count && keys[static_cast<std::size_t>(i + 1)].time <= time) ++i;
    const Key a = keyAt(i), b = keyAt(i + 1);
    const double length = b.time - a.time, share = std::clamp((time - a.time) / length, 0.0, 1.0);
    const bool hasBefore = loops || i > 0, hasAfter = loops || i + 2 < count;
    const Key before = hasBefore ? keyAt(i - 1) : a, after = hasAfter ? keyAt(i + 2) : b;
    glm::dvec2 place(0);
    for (int axis = 0; axis < 2; ++axis) {
        const double slope = (b.place[axis] - a.place[axis]) / length;
        const auto slopeTo = [&](const Key& from, const Key& to) {
            return (to.place[axis] - from.place[axis]) / (to.time - from.time);
        };
        const double slopeA = hasBefore ? slopeAt(slopeTo(before, a), a.time - before.time, slope, length) : 0;
        const double slopeB = hasAfter ? slopeAt(slope, length, slopeTo(b, after), after.time - b.time) : 0;
        place[axis] = eased(a.place[axis], slopeA, b.place[axis], slopeB, length, share);
    }
    return place;
}

std::vector<glm::dvec2> HandleMotion::placesAt(double time) const {
    std::vector<glm::dvec2> places;
    for (const Handle& handle : handles) places.push_back(placeAt(handle, time));
    return places;
}

Result<HandleMotion> readMotion(const fs::path& file, const TriangulatedSilhouette& silhouette) {
    HandleMotion motion;
    ConfigFields fields(TRY(ConfigNode::load(file)));
    fields.header("motion", kVersion);
    fields.number("seconds", motion.seconds, kLeastSeconds, kMostSeconds, "s");
    fields.optional().number("frames_per_second", motion.framesPerSecond, HandleMotion::kLeastFramesPerSecond,
                             HandleMotion::kMostFramesPerSecond);
    fields.optional().boolean("loop", motion.loops);
    MotionReader reader(silhouette, motion);
    fields.list(
        "handles", motion.handles, [&](const ConfigNode& node) { return reader.readHandle(node); }, 1, kMostHandles);
    TRY(fields.finish());
    return motion;
}

}  // namespace fantascope::theatre
