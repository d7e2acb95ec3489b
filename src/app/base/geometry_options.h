#pragma once
// Options that are points and sizes, the same in every subcommand.

#include "app/base/command_line.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>
#include <string>

namespace fantascope::app {

// --name WIDTHxHEIGHT, in pixels: 2 .. 16384 each.
Option addSizeOption(Command& command, const std::string& name, std::optional<glm::ivec2>& target,
                     const std::string& description);
// --name X,Y,Z
Option addPointOption(Command& command, const std::string& name, std::optional<glm::dvec3>& target,
                      const std::string& description);

}  // namespace fantascope::app
