#include "drivers/dmx/udp_socket.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace fantascope::drivers {
namespace {

// Bytes; room for what hundreds of universes send while this program is busy. The system may grant
// less.
constexpr int kReceiveBuffer = 4 << 20;

// The interface has a link. IFF_RUNNING shows it up to a second late. (IFF_LOWER_UP is missing from
// <net/if.h>.)
constexpr unsigned kLowerUp = 1u << 16;

Ipv4 ipv4Of(const sockaddr* address) {
    if (address == nullptr || address->sa_family != AF_INET) return {};
    sockaddr_in internet{};
    std::memcpy(&internet, address, sizeof internet);
    return {ntohl(internet.sin_addr.s_addr)};
}

sockaddr_in systemAddress(Endpoint endpoint) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(endpoint.port);
    address.sin_addr.s_addr = htonl(endpoint.address.bits);
    return address;
}

ip_mreqn onInterface(const NetworkInterface& interface, Ipv4 group) {
    ip_mreqn request{};
    request.imr_multiaddr.s_addr = htonl(group.bits);
    request.imr_address.s_addr = htonl(interface.address.bits);
    request.imr_ifindex = static_cast<int>(if_nametoindex(interface.name.c_str()));
    return request;
}

template <class Value>
bool set(int file, int level, int option, const Value& value) {
    return setsockopt(file, level, option, &value, sizeof value) == 0;
}

std::array<std::uint8_t, 6> hardwareAddress(int file, const char* interface) {
    ifreq request{};
    std::strncpy(request.ifr_name, interface, IFNAMSIZ - 1);
    std::array<std::uint8_t, 6> address{};
    if (ioctl(file, SIOCGIFHWADDR, &request) == 0) std::memcpy(address.data(), request.ifr_hwaddr.sa_data, address.size());
    return address;
}

FileHandle udpFile() { return FileHandle(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)); }

}  // namespace

std::string textOf(Ipv4 address) {
    return fmt::format("{}.{}.{}.{}", address.bits >> 24, address.bits >> 16 & 255, address.bits >> 8 & 255, address.bits & 255);
}

std::optional<Ipv4> ipv4Of(const std::string& text) {
    in_addr address{};
    if (inet_pton(AF_INET, text.c_str(), &address) != 1) return std::nullopt;
    return Ipv4{ntohl(address.s_addr)};
}

Result<Ipv4> ipv4Of(const ConfigNode& node) {
    const std::string text = TRY(node.text());
    const auto address = ipv4Of(text);
    if (!address) return node.error(fmt::format("an address such as 10.0.0.5 is needed, here is '{}'", text));
    if (address->bits == 0 || address->bits >> 28 >= 0xe)
        return node.error(fmt::format("the address of a single device is needed, {} is not one", text));
    return *address;
}

std::vector<NetworkInterface> networkInterfaces() {
    std::vector<NetworkInterface> interfaces;
    ifaddrs* first = nullptr;
    if (getifaddrs(&first) != 0) return interfaces;
    const FileHandle file = udpFile();
    for (const ifaddrs* entry = first; entry != nullptr; entry = entry->ifa_next) {
        const Ipv4 address = ipv4Of(entry->ifa_addr);
        if (address.bits == 0) continue;
        constexpr unsigned kUp = IFF_UP | IFF_RUNNING | kLowerUp;
        const std::uint32_t mask = ipv4Of(entry->ifa_netmask).bits;
        interfaces.push_back({entry->ifa_name,
                              address,
                              {address.bits | ~mask},
                              hardwareAddress(file.get(), entry->ifa_name),
                              (entry->ifa_flags & IFF_LOOPBACK) != 0,
                              (entry->ifa_flags & kUp) == kUp});
    }
    freeifaddrs(first);
    return interfaces;
}

std::optional<Outage> whyNoInterface(std::string_view wanted, NetworkInterface& found) {
    std::vector<NetworkInterface> fitting;
    for (NetworkInterface& interface : networkInterfaces()) {
        const bool fits = wanted.empty() ? !interface.loopback : interface.name == wanted || textOf(interface.address) == wanted;
        if (fits) fitting.push_back(std::move(interface));
    }
    if (fitting.empty())
        return Outage{DeviceState::Absent, wanted.empty() ? "this machine is on no network: no interface has an IPv4 address"
                                                          : fmt::format("there is no interface {} with an IPv4 address", wanted)};
    // An interface may have several addresses; the first counts.
    if (wanted.empty() && fitting.front().name != fitting.back().name) {
        std::vector<std::string> names;
        for (const NetworkInterface& interface : fitting)
            if (names.empty() || names.back() != interface.name) names.push_back(interface.name);
        return Outage{DeviceState::Faulted, fmt::format("this machine is on several networks ({}): choose one with 'interface'",
                                                        fmt::join(names, ", "))};
    }
    found = fitting.front();
    if (found.up) return std::nullopt;
    return Outage{DeviceState::Absent, fmt::format("{} has no link: check its cable", found.name)};
}

std::string onWhichInterface(const std::string& wanted) {
    NetworkInterface found;
    (void)whyNoInterface(wanted, found);
    const std::string& name = found.name.empty() ? wanted : found.name;
    return name.empty() ? "" : " on " + name;
}

Result<UdpSocket> UdpSocket::open(const NetworkInterface& interface, std::uint16_t port) {
    UdpSocket socket = TRY(sharable().in(interface.name));
    const int file = socket.file();
    const bool there = setsockopt(file, SOL_SOCKET, SO_BINDTODEVICE, interface.name.c_str(),
                                  static_cast<socklen_t>(interface.name.size())) == 0 &&
                       set(file, IPPROTO_IP, IP_MULTICAST_IF, onInterface(interface, {}));
    if (!there) return Error(fmt::format("{}: no socket: {}", interface.name, systemMessage(errno)));
    if (port != 0) TRY(socket.bindTo(port).in(interface.name));
    return socket;
}

Result<UdpSocket> UdpSocket::openAnywhere(std::uint16_t port) {
    UdpSocket socket = TRY(sharable());
    TRY(socket.bindTo(port));
    return socket;
}

Result<UdpSocket> UdpSocket::sharable() {
    UdpSocket socket(udpFile());
    const int yes = 1;
    if (!socket.file_.isOpen() || !set(socket.file(), SOL_SOCKET, SO_REUSEADDR, yes) ||
        !set(socket.file(), SOL_SOCKET, SO_BROADCAST, yes))
        return Error("no socket: " + systemMessage(errno));
    return socket;
}

Result<void> UdpSocket::bindTo(std::uint16_t port) {
    if (!set(file(), SOL_SOCKET, SO_RCVBUFFORCE, kReceiveBuffer)) set(file(), SOL_SOCKET, SO_RCVBUF, kReceiveBuffer);
    const sockaddr_in here = systemAddress({{INADDR_ANY}, port});
    if (bind(file(), reinterpret_cast<const sockaddr*>(&here), sizeof here) == 0) return {};
    return Error(fmt::format("UDP port {}: {}: another program uses it exclusively", port, systemMessage(errno)));
}

int UdpSocket::send(std::span<const std::uint8_t> bytes, Endpoint to) {
    const sockaddr_in there = systemAddress(to);
    if (sendto(file_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&there),
               sizeof there) >= 0)
        return 0;
    return errno == EAGAIN || errno == ENOBUFS ? 0 : errno;
}

std::optional<std::size_t> UdpSocket::receive(std::span<std::uint8_t> buffer, Endpoint& from) {
    sockaddr_in there{};
    socklen_t size = sizeof there;
    const ssize_t count =
        recvfrom(file_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&there), &size);
    if (count < 0) return std::nullopt;
    from = {{ntohl(there.sin_addr.s_addr)}, ntohs(there.sin_port)};
    return static_cast<std::size_t>(count);
}

Result<Membership> Membership::join(const NetworkInterface& interface, Ipv4 group) {
    FileHandle file = udpFile();
    if (!file.isOpen() || !set(file.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, onInterface(interface, group)))
        return Error(fmt::format("cannot join {} on {}: {}", textOf(group), interface.name, systemMessage(errno)));
    return Membership(std::move(file));
}

}  // namespace fantascope::drivers
