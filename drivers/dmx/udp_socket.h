#pragma once

#include "drivers/common/file_handle.h"

#include "core/config/config.h"
#include "core/result.h"

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::drivers {

// An IPv4 address: 10.0.0.5 is 0x0a000005.
struct Ipv4 {
    std::uint32_t bits = 0;
    friend auto operator<=>(const Ipv4&, const Ipv4&) = default;
};
std::string textOf(Ipv4 address);
std::optional<Ipv4> ipv4Of(const std::string& text);  // "10.0.0.5"; nothing for a host name, because a look-up could block
// The same from a site file. Error: its place, and what is needed.
Result<Ipv4> ipv4Of(const ConfigNode& node);

struct Endpoint {
    Ipv4 address;
    std::uint16_t port = 0;
};

// A network interface of this machine that has an address.
struct NetworkInterface {
    std::string name;  // "eth0"
    Ipv4 address, broadcast;
    std::array<std::uint8_t, 6> hardware{};  // its MAC
    bool loopback = false;
    bool up = false;  // switched on, with a link
    friend bool operator==(const NetworkInterface&, const NetworkInterface&) = default;
};
std::vector<NetworkInterface> networkInterfaces();

// Finds the interface that a site file names by name or address; "" means the only one besides the
// loopback. Returns why it cannot be used, or nothing and sets `found`.
std::optional<Outage> whyNoInterface(std::string_view wanted, NetworkInterface& found);
// The interface's part of a claim: " on eth0". If it is not found: what the site file says.
std::string onWhichInterface(const std::string& wanted);

// A UDP socket that sends and receives on one interface only. Other programs may share its port if
// they allow sharing too. No call waits. Thread: thread-bound.
class UdpSocket {
public:
    UdpSocket() = default;  // not open
    // Port 0: any port, to send only. Errors are the system's and name the port.
    static Result<UdpSocket> open(const NetworkInterface& interface, std::uint16_t port);
    // Receives on every interface. But of unicast to this machine it gets only what no socket of a
    // single interface takes.
    static Result<UdpSocket> openAnywhere(std::uint16_t port);

    // Returns the errno of a failure, or 0. If the line or the neighbour accepts nothing now, the
    // datagram is lost; that is no error.
    int send(std::span<const std::uint8_t> bytes, Endpoint to);
    // Writes the next datagram to the front of `buffer` and returns its size; nothing if there is
    // none.
    std::optional<std::size_t> receive(std::span<std::uint8_t> buffer, Endpoint& from);
    int file() const { return file_.get(); }

private:
    explicit UdpSocket(FileHandle file) : file_(std::move(file)) {}
    static Result<UdpSocket> sharable();
    Result<void> bindTo(std::uint16_t port);
    FileHandle file_;
};

// Membership in a multicast group: while it lives, every UdpSocket on the interface receives the
// group's packets. Each has a socket of its own, because a socket may join only a few groups
// (net.ipv4.igmp_max_memberships).
class Membership {
public:
    static Result<Membership> join(const NetworkInterface& interface, Ipv4 group);

private:
    explicit Membership(FileHandle file) : file_(std::move(file)) {}
    FileHandle file_;
};

}  // namespace fantascope::drivers
