#pragma once

#include "device/status.h"

#include "core/result.h"

#include <filesystem>
#include <string>
#include <utility>

namespace fantascope::drivers {

// An open file descriptor; the destructor closes it.
class FileHandle {
public:
    FileHandle() = default;
    explicit FileHandle(int file) : file_(file) {}
    ~FileHandle();
    FileHandle(FileHandle&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
    FileHandle& operator=(FileHandle&& other) noexcept {
        std::swap(file_, other.file_);
        return *this;
    }

    int get() const { return file_; }
    bool isOpen() const { return file_ >= 0; }

private:
    int file_ = -1;
};

// Why a device is not Running, and what to do about it.
struct Outage {
    DeviceState state = DeviceState::Absent;
    std::string why;
};
// From the errno of an open() that failed. If permission is missing, it names the group that owns
// the file and the udev rules that come with this program (systemd/70-fantascope.rules).
Outage whyNotOpened(const std::filesystem::path& file, int error);

// The system's message for an errno: "No such device".
std::string systemMessage(int error);

}  // namespace fantascope::drivers
