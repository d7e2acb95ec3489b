#pragma once

#include "drivers/common/file_handle.h"

#include "core/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace fantascope::drivers {

// The holder of a claim.
struct ClaimHolder {
    int process = 0;      // that made the claim; 0: unknown
    std::string command;  // its command line; "" once it has ended and its relay guard holds the claim
    bool hasEnded() const { return process != 0 && command.empty(); }
    std::string words() const;  // "process 812 (fantascope run shows/x --site y)"
};

// The exclusive use of a thing, identified by a name that all programs on this machine (in this
// network namespace) agree on. A claim lasts while any process has its file open. A child that
// inherits the file shares the claim; the kernel releases it when the last such process ends,
// however it ends. Thread: reentrant.
class Claim {
public:
    // Nothing: another program holds it.
    static std::optional<Claim> take(const std::string& name);
    int file() const { return socket_.get(); }

private:
    explicit Claim(FileHandle socket) : socket_(std::move(socket)) {}
    FileHandle socket_;
};

// The name of the claim on a device file, the same through any link to it: "serial line
// /dev/ttyUSB0".
std::string claimOfFile(std::string_view kind, const std::filesystem::path& file);
constexpr std::string_view kSerialLine = "serial line";  // the kind that all families on serial lines use

// Whether it is claimed. May be called any number of times. holderOf() may not: each of its calls
// leaves an entry in the holder's queue.
bool isClaimed(const std::string& name);
// The holder; nothing if it is not claimed.
std::optional<ClaimHolder> holderOf(const std::string& name);

}  // namespace fantascope::drivers
