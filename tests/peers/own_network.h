#pragma once
// A network of the test's own, so that nothing of it is ever heard outside: this program in a
// network namespace, another namespace beside it, and two cables between them.
//
//     here: near 10.77.0.1/24 ──── far 10.77.0.2 and .11 to .19, there
//           aside 10.78.0.1/24 ─── apart 10.78.0.2

#include "drivers/common/file_handle.h"

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::peers {

// Puts this program into a namespace of its own: before main() starts any thread. Why that is not
// permitted, or "".
std::string enterOwnNetwork();
// Why the tests of this program cannot run, or ""; as enterOwnNetwork() said.
const std::string& whyNoNetwork();

// Does something in the far namespace: sockets that are opened and programs that are started there
// are there for good.
void there(const std::function<void()>& what);
template <class Make>
auto madeThere(Make make) {
    decltype(make()) made;
    there([&] { made = make(); });
    return made;
}
// Switches an interface on or off: "near", "far", ...
void setLink(const std::string& interface, bool up);

// A UDP socket of the test's, apart from the program's own code.
class PlainSocket {
public:
    PlainSocket() = default;
    // Bound to `address` ("" is any) and `port`, shared with others, on `interface`.
    PlainSocket(const std::string& interface, const std::string& address, int port);
    void join(const std::string& interface, const std::string& group);
    // False: it could not be sent.
    bool send(std::span<const std::uint8_t> bytes, const std::string& to, int port);
    // What arrives within `patience` milliseconds: empty if nothing does. `from` is told the
    // sender's address.
    std::vector<std::uint8_t> receive(int patience, std::string* from = nullptr);

private:
    drivers::FileHandle file_;
};

// Waits until a condition holds, and asks for it again whenever something may have happened: false
// after half a minute without.
bool eventually(const std::function<bool()>& condition);

// Another program, ended with its owner.
class Peer {
public:
    Peer() = default;
    // `arguments` with the program's name first. Its output goes to `log`. As another user than
    // root where we are root.
    Peer(const std::vector<std::string>& arguments, const std::string& log, bool asNobody = false);
    ~Peer();
    Peer(Peer&& other) noexcept : process_(std::exchange(other.process_, -1)) {}
    Peer& operator=(Peer&& other) noexcept {
        std::swap(process_, other.process_);
        return *this;
    }
    // Sends SIGINT or another and waits for its end: its status, or 128 + a signal.
    int stop(int signal);
    int wait();
    bool isRunning();

private:
    int process_ = -1;
};
// Runs it to its end: its status.
int runPeer(const std::vector<std::string>& arguments, const std::string& log);
bool isInstalled(const std::string& program);

}  // namespace fantascope::peers
