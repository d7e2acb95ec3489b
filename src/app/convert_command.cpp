#include "app/convert_command.h"

namespace fantascope::app {
void addConvertCommand(CLI::App&, Action&) {}
}  // namespace fantascope::app
