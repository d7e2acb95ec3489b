#pragma once

#include "device/status.h"

#include "core/result.h"

#include <filesystem>
#include <string>
#include <utility>

namespace fantascope::drivers {

// An open file of the system, closed with its owner.
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

// Why a device's file cannot be opened, from errno: what the device is then, and what to do about
// it. Without permission it names the group that has it, and the rules file for udev that this
// program comes with (systemd/70-fantascope.rules).
struct Outage {
    DeviceState state = DeviceState::Absent;
    std::string why;
};
Outage whyNotOpened(const std::filesystem::path& file, int error);

// The system's words for an errno: "No such device".
std::string systemMessage(int error);

}  // namespace fantascope::drivers
