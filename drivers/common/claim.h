#pragma once

#include "drivers/common/file_handle.h"

#include "core/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace fantascope::drivers {

// Who has claimed something.
struct ClaimHolder {
    int process = 0;      // who made the claim; 0: it cannot be told
    std::string command;  // its command line; "" once it has ended: then its relay guard has the claim
    bool hasEnded() const { return process != 0 && command.empty(); }
    std::string words() const;  // "process 812 (fantascope run shows/x --site y)"
};

// A thing that one program at a time may use, by a name that all programs on this machine (in this
// network namespace) agree on. The claim holds for as long as any process has its file open, so a
// child that inherits the file shares it, and the kernel releases it when the last one ends,
// whatever ends it. Thread: reentrant.
class Claim {
public:
    // Nothing: somebody else has it.
    static std::optional<Claim> take(const std::string& name);
    int file() const { return socket_.get(); }

private:
    explicit Claim(FileHandle socket) : socket_(std::move(socket)) {}
    FileHandle socket_;
};

// What is claimed of a device's file, whichever of its links is given: "serial line /dev/ttyUSB0".
std::string claimOfFile(std::string_view kind, const std::filesystem::path& file);
constexpr std::string_view kSerialLine = "serial line";  // the kind; families that share lines call them alike

// Whether somebody has claimed this. May be asked for ever, which holderOf() may not: who holds a
// claim keeps a note of every question.
bool isClaimed(const std::string& name);
// Who has claimed this; nothing: nobody.
std::optional<ClaimHolder> holderOf(const std::string& name);

}  // namespace fantascope::drivers
