#include "app/base/geometry_options.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

namespace fantascope::app {
namespace {

constexpr int kLargestSide = 16384;

std::optional<glm::ivec2> sizeFrom(const std::string& text) {
    glm::ivec2 size(0);
    char more = 0;
    if (std::sscanf(text.c_str(), "%dx%d%c", &size.x, &size.y, &more) != 2) return std::nullopt;
    const auto fits = [](int side) { return side >= 2 && side <= kLargestSide; };
    return fits(size.x) && fits(size.y) ? std::optional(size) : std::nullopt;
}

std::optional<glm::dvec3> pointFrom(const std::string& text) {
    glm::dvec3 point(0);
    char more = 0;
    if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &point.x, &point.y, &point.z, &more) != 3) return std::nullopt;
    const bool finite = std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
    return finite ? std::optional(point) : std::nullopt;
}

template <class Value>
Option addParsed(Command& command, const std::string& name, std::optional<Value>& target, const std::string& description,
                 std::optional<Value> (*parse)(const std::string&), const std::string& form) {
    const auto take = [&target, parse, form](const std::string& text) {
        target = parse(text);
        return target ? "" : fmt::format("'{}' is not {}", text, form);
    };
    return command.addParsed(name, take, description).typeName(form);
}

}  // namespace

Option addSizeOption(Command& command, const std::string& name, std::optional<glm::ivec2>& target,
                     const std::string& description) {
    return addParsed(command, name, target, description, sizeFrom, fmt::format("WIDTHxHEIGHT, 2 .. {} px each", kLargestSide));
}

Option addPointOption(Command& command, const std::string& name, std::optional<glm::dvec3>& target,
                      const std::string& description) {
    return addParsed(command, name, target, description, pointFrom, "X,Y,Z");
}

}  // namespace fantascope::app
