// Measures how evenly levels leave this machine over the loopback: our packets, those of every
// other Art-Net sender heard meanwhile, and for comparison a latency probe, an idle timer of the
// same rate. Packet times are the kernel's. bench/dmx runs it with QLC+ playing.

#include "drivers/registry.h"

#include "core/clock.h"

#include <CLI/CLI.hpp>
#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <map>
#include <thread>
#include <vector>

namespace fantascope {
namespace {

constexpr int kFirst = 100, kUniverses = 4;  // our universes, as port-addresses
constexpr int kArtnetPort = 6454;

// Records when each packet of levels arrives, by port-address.
class Listener {
public:
    Listener() : file_(socket(AF_INET, SOCK_DGRAM, 0)) {
        const int yes = 1;
        setsockopt(file_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        setsockopt(file_, SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof yes);
        // Of all sockets on a port, the most narrowly bound one gets unicast packets.
        setsockopt(file_, SOL_SOCKET, SO_BINDTODEVICE, "lo", 2);
        sockaddr_in here{};
        here.sin_family = AF_INET;
        here.sin_port = htons(kArtnetPort);
        here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        isOpen_ = bind(file_, reinterpret_cast<const sockaddr*>(&here), sizeof here) == 0;
    }
    ~Listener() { close(file_); }
    bool isOpen() const { return isOpen_; }

    void listen(int timeout) {
        pollfd waited{file_, POLLIN, 0};
        if (poll(&waited, 1, timeout) <= 0) return;
        std::array<std::uint8_t, 1500> bytes;
        std::array<char, 256> control;
        iovec part{bytes.data(), bytes.size()};
        msghdr message{};
        message.msg_iov = &part;
        message.msg_iovlen = 1;
        message.msg_control = control.data();
        message.msg_controllen = control.size();
        const ssize_t size = recvmsg(file_, &message, 0);
        if (size < 20 || std::memcmp(bytes.data(), "Art-Net\0\0\x50", 10) != 0) return;
        for (cmsghdr* header = CMSG_FIRSTHDR(&message); header != nullptr; header = CMSG_NXTHDR(&message, header)) {
            if (header->cmsg_level != SOL_SOCKET || header->cmsg_type != SO_TIMESTAMPNS) continue;
            timespec at{};
            std::memcpy(&at, CMSG_DATA(header), sizeof at);
            times_[bytes[15] << 8 | bytes[14]].push_back(std::chrono::seconds(at.tv_sec) + std::chrono::nanoseconds(at.tv_nsec));
        }
    }
    const std::map<int, std::vector<Time>>& times() const { return times_; }

private:
    int file_;
    bool isOpen_ = false;
    std::map<int, std::vector<Time>> times_;
};

double milliseconds(Time time) { return 1e3 * seconds(time); }

// Prints the intervals' deviation from their median.
void report(const std::string& name, const std::vector<Time>& times) {
    std::vector<Time> intervals, deviations;
    for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(times[i] - times[i - 1]);
    if (intervals.size() < 100) {
        fmt::print("{:<22} only {} packets\n", name, times.size());
        return;
    }
    std::sort(intervals.begin(), intervals.end());
    const Time period = intervals[intervals.size() / 2];
    for (const Time interval : intervals) deviations.push_back(std::chrono::abs(interval - period));
    std::sort(deviations.begin(), deviations.end());
    const auto share = [&](double part) {
        return milliseconds(deviations[static_cast<std::size_t>(part * static_cast<double>(deviations.size() - 1))]);
    };
    fmt::print("{:<22} {:6} intervals, period {:7.3f} ms, deviation p50 {:6.3f} p99 {:7.3f} max {:7.3f} ms\n", name,
               intervals.size(), milliseconds(period), share(0.5), share(0.99), share(1));
}

int run(double length, const std::string& deadNode, int show) {
    SteadyClock clock;
    Listener listener;
    if (!listener.isOpen()) {
        fmt::print(stderr, "UDP port {} is in use by a program that does not share it\n", kArtnetPort);
        return 1;
    }
    const drivers::DriverContext context{clock};
    std::vector<std::unique_ptr<DmxPort>> ports;
    const auto send = [&](int universe, const std::string& keys) {
        const auto options = ConfigNode::parse("driver: artnet\n" + keys + "poll: false\n", "bench.yaml").value();
        ports.push_back(drivers::openDmxPort(options, universe, context).value());
    };
    for (int i = 0; i < kUniverses; ++i) send(kFirst + i, "interface: lo\nnode: 127.0.0.1\n");
    if (!deadNode.empty()) send(kFirst + kUniverses, "interface: near\nnode: " + deadNode + "\n");
    const Time end = clock.now() + fromSeconds(length);

    // Changes levels at the rate of the lighting thread.
    std::jthread lighting([&] {
        constexpr double kRate = 40;
        std::array<std::uint8_t, kDmxSlots> slots{};
        for (std::int64_t tick = tickAt(clock.now(), kRate) + 1; tickTime(tick, kRate) < end; ++tick) {
            clock.sleepUntil(tickTime(tick, kRate));
            slots.fill(static_cast<std::uint8_t>(tick));
            for (const auto& port : ports) (void)port->send(slots);
        }
    });
    std::vector<Time> idleTimes;
    std::jthread timer([&] {
        constexpr double kRate = 44;
        for (std::int64_t tick = tickAt(clock.now(), kRate) + 1; tickTime(tick, kRate) < end; ++tick) {
            clock.sleepUntil(tickTime(tick, kRate));
            idleTimes.push_back(clock.now());
        }
    });
    while (clock.now() < end) listener.listen(10);
    lighting.join();
    timer.join();
    for (const auto& [portAddress, times] : listener.times()) {
        const bool ours = portAddress >= kFirst && portAddress < kFirst + kUniverses;
        const char* const whose = ours ? "ours" : portAddress == show ? "the show's" : "another sender's";
        report(fmt::format("{} {}", whose, portAddress), times);
    }
    report("latency probe", idleTimes);
    return 0;
}

}  // namespace
}  // namespace fantascope

int main(int count, char** arguments) {
    CLI::App app("Measures how evenly levels leave this machine");
    double length = 20;
    app.add_option("--seconds", length, "Length of the measurement")->check(CLI::Range(1.0, 3600.0));
    std::string deadNode;
    app.add_option("--dead-node", deadNode, "An unused address behind the interface 'near', which is sent a universe too");
    int show = -1;
    app.add_option("--show", show, "The port-address that a show sends to meanwhile");
    CLI11_PARSE(app, count, arguments);
    return fantascope::run(length, deadNode, show);
}
