#pragma once

#include "drivers/common/file_handle.h"

#include "core/config.h"
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

// An address of the internet protocol, version 4: 10.0.0.5 is 0x0a000005.
struct Ipv4 {
    std::uint32_t bits = 0;
    friend auto operator<=>(const Ipv4&, const Ipv4&) = default;
};
std::string textOf(Ipv4 address);
std::optional<Ipv4> ipv4Of(const std::string& text);  // "10.0.0.5"; nothing for a name: nobody waits for a name server here
// The same of a site file. Error: its place, and what is wanted.
Result<Ipv4> ipv4Of(const ConfigNode& node);

struct Endpoint {
    Ipv4 address;
    std::uint16_t port = 0;
};

// One of this machine's network interfaces that has an address.
struct NetworkInterface {
    std::string name;  // "eth0"
    Ipv4 address, broadcast;
    std::array<std::uint8_t, 6> hardware{};  // its MAC
    bool loopback = false;
    bool up = false;  // switched on, and its cable leads to something
    friend bool operator==(const NetworkInterface&, const NetworkInterface&) = default;
};
std::vector<NetworkInterface> networkInterfaces();

// Finds the interface that a site file means by its name or its address; by "" it means the only
// one that there is besides the loopback. Why it cannot be used, or nothing and `found` is set.
std::optional<Outage> whyNoInterface(std::string_view wanted, NetworkInterface& found);
// What a claim adds for the interface: " on eth0". While none is found: what the site file says.
std::string onWhichInterface(const std::string& wanted);

// A UDP socket on one interface: it hears and speaks there and nowhere else. It shares its port
// with other programs that share theirs. No call ever waits. Thread: thread-bound.
class UdpSocket {
public:
    UdpSocket() = default;  // none yet
    // Port 0: any, for sending alone. Errors are the system's and name the port.
    static Result<UdpSocket> open(const NetworkInterface& interface, std::uint16_t port);
    // One that hears every interface, but of what is sent to this machine alone only what no socket
    // of an interface takes.
    static Result<UdpSocket> openAnywhere(std::uint16_t port);

    // The errno of what went wrong. A line or a neighbour that takes nothing more just now loses
    // the datagram and is no error.
    int send(std::span<const std::uint8_t> bytes, Endpoint to);
    // What has arrived, written to the front of `buffer`: its size, or nothing when there is none.
    std::optional<std::size_t> receive(std::span<std::uint8_t> buffer, Endpoint& from);
    int file() const { return file_.get(); }

private:
    explicit UdpSocket(FileHandle file) : file_(std::move(file)) {}
    static Result<UdpSocket> sharable();
    Result<void> bindTo(std::uint16_t port);
    FileHandle file_;
};

// As long as it lives, this machine asks its network for what is sent to a multicast group, and
// every UdpSocket on that interface hears it. (A socket of its own for each group: one socket may
// join but few, net.ipv4.igmp_max_memberships.)
class Membership {
public:
    static Result<Membership> join(const NetworkInterface& interface, Ipv4 group);

private:
    explicit Membership(FileHandle file) : file_(std::move(file)) {}
    FileHandle file_;
};

}  // namespace fantascope::drivers
