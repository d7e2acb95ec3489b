#include "drivers/common/file_handle.h"

#include <fmt/format.h>
#include <grp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace fantascope::drivers {
namespace {

// The group that owns a file; "" if it has no name.
std::string groupOf(const std::filesystem::path& file) {
    struct stat known {};
    if (stat(file.c_str(), &known) != 0) return "";
    char buffer[4096];
    group entry{}, *found = nullptr;
    if (getgrgid_r(known.st_gid, &entry, buffer, sizeof buffer, &found) != 0 || found == nullptr) return "";
    return found->gr_name;
}

}  // namespace

FileHandle::~FileHandle() {
    if (file_ >= 0) close(file_);
}

std::string systemMessage(int error) { return std::generic_category().message(error); }

Outage whyNotOpened(const std::filesystem::path& file, int error) {
    if (error == ENOENT || error == ENODEV || error == ENXIO)
        return {DeviceState::Absent, fmt::format("{} is not there", file.string())};
    if (error != EACCES && error != EPERM)
        return {DeviceState::Faulted, fmt::format("{}: {}", file.string(), systemMessage(error))};
    const std::string group = groupOf(file);
    const bool forOthers = !group.empty() && group != "root";
    return {DeviceState::Faulted,
            fmt::format("no permission for {}: install systemd/70-fantascope.rules as its first line says{}", file.string(),
                        forOthers ? fmt::format(", or put the user in the group {}", group) : "")};
}

}  // namespace fantascope::drivers
