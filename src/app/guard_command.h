#pragma once

#include "app/command.h"

#include <string_view>

namespace fantascope::app {

// What a RelayGuard starts; not for people, so no help names it.
constexpr const char* kGuardCommand = "guard-relays";
// What a run that has ended in order leaves in the guard's pipe.
constexpr std::string_view kAllIsSafe = "safe\n";

void addGuardCommand(CLI::App& program, Action& action);

}  // namespace fantascope::app
