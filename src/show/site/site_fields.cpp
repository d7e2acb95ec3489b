#include "show/site/site_fields.h"

namespace fantascope::show {
Result<std::string> readName(const ConfigNode& node) {
    const std::string name = TRY(node.text());
    if (name.starts_with('.') || name.find('/') != std::string::npos)
        return node.error(fmt::format("'{}' is no name: it may not contain a '/' or begin with a '.'", name));
    return name;
}

Result<DeviceConfig> readDevice(const ConfigNode& node) {
    if (const auto driver = node.find("driver")) return DeviceConfig{TRY(driver->text()), node};
    TRY(node.entries());  // it is a map
    return node.error("'driver' is missing: the name of the device's driver");
}

Result<glm::ivec2> readSize(const ConfigNode& node) {
    const auto sides = TRY(node.items(2, 2));
    return glm::ivec2(TRY(sides[0].integer(1, kMostPixels)), TRY(sides[1].integer(1, kMostPixels)));
}

Result<glm::ivec2> readWholePixel(const ConfigNode& node) {
    const auto place = TRY(node.items(2, 2));
    return glm::ivec2(TRY(place[0].integer(0, kMostPixels - 1)), TRY(place[1].integer(0, kMostPixels - 1)));
}

Result<std::vector<double>> readResponse(const ConfigNode& node) {
    std::vector<double> response;
    for (const ConfigNode& item : TRY(node.items(2, 256))) {
        response.push_back(TRY(item.number(0, 1)));
        if (response.size() > 1 && response.back() < response[response.size() - 2])
            return item.error("the light of a higher stored value is smaller; the numbers must rise");
    }
    if (response.front() != 0 || response.back() != 1)
        return node.error("the numbers must rise from 0, the light of black, to 1, that of full white");
    return response;
}

void Aim::declare(ConfigFields& fields) {
    fields.vector3("position", position, -kFarthest, kFarthest, "m");
    fields.vector3("look_at", target, -kFarthest, kFarthest, "m");
    fields.optional().vector3("up", up, -1, 1);
}

Result<Pose> Aim::pose(const ConfigNode& node) const {
    const auto pose = Pose::lookingAt(position, target, up);
    if (!pose) return node.error(pose.error().message());
    return *pose;
}

}  // namespace fantascope::show
