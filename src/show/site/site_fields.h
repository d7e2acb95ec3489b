#pragma once
// Readers that the sections of a site file share.

#include "show/site/site.h"

#include "core/config/config.h"
#include "core/geometry.h"
#include "core/result.h"

#include <fmt/format.h>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fantascope::show {

constexpr double kFarthest = 1000;  // metres; this limit only catches a wrong digit or unit

// A reader of values that must be unique among all readers that share `taken`.
template <class Value, class Read>
auto once(std::set<Value>& taken, std::string_view owner, Read read) {
    return [&taken, owner, read](const ConfigNode& node) -> Result<Value> {
        const Value value = static_cast<Value>(TRY(read(node)));
        if (!taken.insert(value).second)
            return node.error(fmt::format("{} is taken by another {}; each needs its own", value, owner));
        return value;
    };
}

// Reads a name. It becomes part of the names of recorded files, so some characters are refused.
Result<std::string> readName(const ConfigNode& node);

inline auto onceNamed(std::set<std::string>& taken, std::string_view owner) { return once(taken, owner, readName); }

inline auto onceNumbered(std::set<int>& taken, std::string_view owner, int low, int high) {
    return once(taken, owner, [low, high](const ConfigNode& node) { return node.integer(low, high); });
}

// Reads a device. Only the driver checks its own keys.
Result<DeviceConfig> readDevice(const ConfigNode& node);

// The drivers' findings about the devices. They are reported beside all other faults, so that one
// fault in a device does not hide others.
class DriversWord {
public:
    explicit DriversWord(DeviceReader* reader) : reader_(reader) {}

    // Calls ask(reader) for the device at `at`, if there is a reader.
    template <class Ask>
    void ask(const ConfigNode& at, Ask ask) {
        if (reader_ != nullptr) said_.emplace_back(at, ask(*reader_));
    }
    void tell(ConfigFields& fields) const {
        for (const auto& [at, word] : said_) fields.check(at, word);
    }

private:
    DeviceReader* reader_;
    std::vector<std::pair<ConfigNode, Result<void>>> said_;
};

constexpr int kMostPixels = 16384;  // along one side of a picture: a usual limit of graphics cards
// Reads a size: pixels across and down.
Result<glm::ivec2> readSize(const ConfigNode& node);
// Reads a pixel's column and row.
Result<glm::ivec2> readWholePixel(const ConfigNode& node);

constexpr std::size_t kMostHotPixels = 1000;  // more is no list of single pixels
// Reads a camera's response: 2 .. 256 numbers that rise from 0 to 1.
Result<std::vector<double>> readResponse(const ConfigNode& node);

// The keys that say where a projector or a camera stands, and where it looks. Call pose() after the
// fields are finished.
struct Aim {
    glm::dvec3 position{0.0}, target{0.0}, up{0, 1, 0};

    void declare(ConfigFields& fields);
    // The pose. Error, at the place of `node`: the keys give no direction of view.
    Result<Pose> pose(const ConfigNode& node) const;
};

}  // namespace fantascope::show
