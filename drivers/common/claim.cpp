#include "drivers/common/claim.h"

#include "core/hash.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

namespace fantascope::drivers {
namespace {

// The most calls of holderOf() during one claim: their connections queue up, and nobody accepts
// them.
constexpr int kAskers = 4096;

// A hash, because a file name may be longer than an address.
std::string labelOf(const std::string& name) { return fmt::format("fantascope-claim-{:016x}", fnv1a(name)); }

// An abstract address, because a crash leaves no file behind.
std::pair<sockaddr_un, socklen_t> addressOf(const std::string& name) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string text = labelOf(name);
    std::copy(text.begin(), text.end(), address.sun_path + 1);
    return {address, static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size())};
}

FileHandle newSocket() { return FileHandle(socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)); }

// "" for a process that has ended, a zombie included.
std::string commandOf(pid_t process) {
    std::ifstream file(fmt::format("/proc/{}/cmdline", process), std::ios::binary);
    std::string command(std::istreambuf_iterator<char>(file), {});
    while (!command.empty() && command.back() == '\0') command.pop_back();
    std::replace(command.begin(), command.end(), '\0', ' ');
    return command;
}

}  // namespace

std::string ClaimHolder::words() const {
    if (process == 0) return "another program";
    return command.empty() ? fmt::format("the relay guard of process {}, which has ended", process)
                           : fmt::format("process {} ({})", process, command);
}

std::optional<Claim> Claim::take(const std::string& name) {
    FileHandle file = newSocket();
    const auto [address, size] = addressOf(name);
    if (bind(file.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0 || listen(file.get(), kAskers) != 0)
        return std::nullopt;
    return Claim(std::move(file));
}

std::string claimOfFile(std::string_view kind, const std::filesystem::path& file) {
    std::error_code missing;
    const auto target = std::filesystem::canonical(file, missing);
    return fmt::format("{} {}", kind, (missing ? file : target).string());
}

bool isClaimed(const std::string& name) {
    const std::string label = "@" + labelOf(name);
    std::ifstream all("/proc/net/unix");
    for (std::string line; std::getline(all, line);)
        if (line.ends_with(label)) return true;
    return false;
}

std::optional<ClaimHolder> holderOf(const std::string& name) {
    const FileHandle file = newSocket();
    const auto [address, size] = addressOf(name);
    if (connect(file.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0)
        return errno == EAGAIN ? std::optional(ClaimHolder{}) : std::nullopt;
    ucred peer{};
    socklen_t length = sizeof peer;
    if (getsockopt(file.get(), SOL_SOCKET, SO_PEERCRED, &peer, &length) != 0) return ClaimHolder{};
    return ClaimHolder{peer.pid, commandOf(peer.pid)};
}

}  // namespace fantascope::drivers
