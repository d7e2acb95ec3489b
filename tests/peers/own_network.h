#pragma once
// A private network for a test, so that nothing of it reaches the outside: this program in a
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

// Puts this program into a namespace of its own, before main() starts any thread. Why that is not
// permitted, or "".
std::string enterOwnNetwork();
// Why the tests of this program cannot run, or ""; as enterOwnNetwork() said.
const std::string& whyNoNetwork();

// Runs `what` in the far namespace: sockets opened and programs started there stay there.
void there(const std::function<void()>& what);
template <class Make>
auto madeThere(Make make) {
    decltype(make()) made;
    there([&] { made = make(); });
    return made;
}
// Switches an interface on or off: "near", "far", ...
void setLink(const std::string& interface, bool up);

// A UDP socket of the test, independent of the program's code.
class PlainSocket {
public:
    PlainSocket() = default;
    // Bound to `address` ("" is any) and `port`, shared with others, on `interface`.
    PlainSocket(const std::string& interface, const std::string& address, int port);
    void join(const std::string& interface, const std::string& group);
    // False: it could not be sent.
    bool send(std::span<const std::uint8_t> bytes, const std::string& to, int port);
    // What arrives within `timeout` milliseconds; empty if nothing does. `from` gets the sender's
    // address.
    std::vector<std::uint8_t> receive(int timeout, std::string* from = nullptr);

private:
    drivers::FileHandle file_;
};

// Waits until a condition holds, checking it whenever something may have happened; false after half
// a minute.
bool eventually(const std::function<bool()>& condition);

// Another program, ended with its owner.
class Peer {
public:
    Peer() = default;
    // `arguments` begin with the program's name. Its output goes to `log`. It runs as another user
    // than root if we are root.
    Peer(const std::vector<std::string>& arguments, const std::string& log, bool asNobody = false);
    ~Peer();
    Peer(Peer&& other) noexcept : process_(std::exchange(other.process_, -1)) {}
    Peer& operator=(Peer&& other) noexcept {
        std::swap(process_, other.process_);
        return *this;
    }
    // Sends a signal and waits for its end; returns its status, or 128 + a signal.
    int stop(int signal);
    int wait();
    bool isRunning();

private:
    int process_ = -1;
};
// Runs it to its end; returns its status.
int runPeer(const std::vector<std::string>& arguments, const std::string& log);
bool isInstalled(const std::string& program);

}  // namespace fantascope::peers
