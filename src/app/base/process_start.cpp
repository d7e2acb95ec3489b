#include "app/base/process_start.h"

#include <unistd.h>

#include <ctime>
#include <fstream>
#include <sstream>
#include <string>

namespace fantascope::app {

std::optional<Time> processStart(const Clock& clock) {
    // proc(5): the name may hold anything, but no ")" comes after its own; the start is field 22,
    // in ticks since boot.
    std::ifstream file("/proc/self/stat");
    std::string text;
    std::getline(file, text);
    const std::size_t name = text.rfind(')');
    if (name == std::string::npos) return std::nullopt;
    std::istringstream fields(text.substr(name + 1));
    std::string field;
    for (int number = 3; number <= 22; ++number) fields >> field;
    timespec sinceBoot{};
    const long ticks = ::sysconf(_SC_CLK_TCK);
    if (!fields || ticks <= 0 || ::clock_gettime(CLOCK_BOOTTIME, &sinceBoot) != 0) return std::nullopt;
    const double age = static_cast<double>(sinceBoot.tv_sec) + 1e-9 * static_cast<double>(sinceBoot.tv_nsec) -
                       std::stod(field) / static_cast<double>(ticks);
    return clock.now() - fromSeconds(age);
}

}  // namespace fantascope::app
