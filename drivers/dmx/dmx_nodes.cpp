#include "drivers/dmx/dmx_nodes.h"

#include "drivers/dmx/sacn_packet.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <tuple>
#include <utility>

namespace fantascope::drivers {
namespace {

constexpr std::size_t kMaxNodes = 1000;  // a bound, so that a flood of packets cannot exhaust memory

struct NodePort {
    Ipv4 node;
    int portAddress = 0;
    bool output = false;  // DMX leaves the node here
    friend auto operator<=>(const NodePort&, const NodePort&) = default;
};

struct Nodes {
    std::mutex mutex;
    std::map<NodePort, artnet::PollReply> heard;
};
Nodes& nodes() {
    static Nodes all;
    return all;
}

FoundDevice found(const NodePort& port, const artnet::PollReply& reply) {
    FoundDevice device;
    device.family = "dmx";
    device.what = fmt::format("Art-Net {} {}, {} of port-address {}", reply.controller ? "controller" : "node",
                              reply.longName.empty() ? reply.shortName : reply.longName, port.output ? "output" : "input",
                              port.portAddress);
    device.identity = fmt::format("MAC {:02x}", fmt::join(reply.hardware, ":"));
    device.where = textOf(port.node);
    device.options = fmt::format("{{driver: artnet, {}net: {}, subnet: {}, universe: {}}}",
                                 port.output ? fmt::format("node: {}, ", textOf(port.node)) : "", port.portAddress >> 8,
                                 port.portAddress >> 4 & 15, port.portAddress & 15);
    return device;
}

struct Source {
    std::string name;
    Ipv4 address;
    std::set<int> universes;
};

FoundDevice found(const sacn::Cid& cid, const Source& source) {
    FoundDevice device;
    device.family = "dmx";
    device.what = fmt::format("sACN source {}, sends universes {}", source.name, fmt::join(source.universes, ", "));
    device.identity = fmt::format("CID {}", sacn::textOf(cid));
    device.where = textOf(source.address);
    device.options = "{driver: sacn}";
    return device;
}

}  // namespace

void noteNode(Ipv4 from, const artnet::PollReply& reply) {
    const std::lock_guard lock(nodes().mutex);
    const auto note = [&](int portAddress, bool output) {
        if (nodes().heard.size() < kMaxNodes) nodes().heard.insert_or_assign({from, portAddress, output}, reply);
    };
    for (const int portAddress : reply.outputs) note(portAddress, true);
    for (const int portAddress : reply.inputs) note(portAddress, false);
}

std::vector<FoundDevice> findDmxNodes(Time timeout) {
    {
        const std::lock_guard lock(nodes().mutex);
        nodes().heard.clear();
    }
    auto artSocket = UdpSocket::openAnywhere(artnet::kUdpPort), sacnSocket = UdpSocket::openAnywhere(sacn::kUdpPort);
    std::vector<pollfd> waited;
    for (auto* const socket : {&artSocket, &sacnSocket})
        if (*socket) waited.push_back({(*socket)->file(), POLLIN, 0});
    std::vector<Membership> joined;
    for (const NetworkInterface& interface : networkInterfaces()) {
        if (!interface.up) continue;
        if (artSocket) (void)artSocket->send(bytesOf(artnet::Poll{}), {interface.broadcast, artnet::kUdpPort});
        if (auto group = Membership::join(interface, {sacn::groupOf(sacn::kDiscoveryUniverse)}))
            joined.push_back(std::move(*group));
    }

    std::map<sacn::Cid, Source> sources;
    const SteadyClock clock;
    std::array<std::uint8_t, 1500> buffer;
    Endpoint from;
    for (Time now = clock.now(); now < timeout; now = clock.now()) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(timeout - now);
        poll(waited.data(), waited.size(), static_cast<int>(left.count()));
        while (const auto size = artSocket ? artSocket->receive(buffer, from) : std::nullopt) {
            const auto packet = artnet::read(std::span(buffer).first(*size));
            if (packet && std::holds_alternative<artnet::PollReply>(*packet))
                noteNode(from.address, std::get<artnet::PollReply>(*packet));
        }
        while (const auto size = sacnSocket ? sacnSocket->receive(buffer, from) : std::nullopt) {
            const auto packet = sacn::read(std::span(buffer).first(*size));
            if (!packet || !std::holds_alternative<sacn::Discovery>(*packet) || sources.size() >= kMaxNodes) continue;
            const auto& discovery = std::get<sacn::Discovery>(*packet);
            Source& source = sources[discovery.cid];
            source.name = discovery.name;
            source.address = from.address;
            source.universes.insert(discovery.universes.begin(), discovery.universes.end());
        }
    }

    std::vector<FoundDevice> all;
    {
        const std::lock_guard lock(nodes().mutex);
        for (const auto& [port, reply] : nodes().heard) all.push_back(found(port, reply));
    }
    for (const auto& [cid, source] : sources) all.push_back(found(cid, source));
    return all;
}

}  // namespace fantascope::drivers
