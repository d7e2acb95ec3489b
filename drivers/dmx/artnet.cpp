#include "drivers/dmx/artnet.h"

#include "drivers/common/shared.h"
#include "drivers/dmx/artnet_packet.h"
#include "drivers/dmx/dmx_network.h"
#include "drivers/dmx/dmx_nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace fantascope::drivers {
namespace {

using namespace artnet;

constexpr Time kPoll = std::chrono::milliseconds(2750);  // between 2.5 s and 3 s
constexpr Time kNodeTimeout = std::chrono::seconds(9);   // three polls, each answered within 3 s
constexpr Time kSilence = std::chrono::seconds(10);      // after which a sender is gone
constexpr Time kSyncSilence = std::chrono::seconds(4);   // after which nodes go on without ArtSync

Incoming::Key keyOf(Ipv4 address) {
    Incoming::Key key{};
    for (std::size_t i = 0; i < 4; ++i) key[i] = static_cast<std::uint8_t>(address.bits >> (24 - 8 * i));
    return key;
}

class ArtnetProtocol final : public DmxProtocol {
public:
    std::uint16_t udpPort() const override { return kUdpPort; }

    void begin(DmxWire&, Time now) override {
        began_ = now;
        nextPoll_ = now;
        heard_.clear();
        syncs_.clear();
    }

    void send(DmxWire& wire, Outgoing& out) override {
        if (++out.sequence == 0) out.sequence = 1;
        const auto bytes = bytesOf(Dmx{out.sequence, out.settings.universe, out.slots});
        if (out.settings.to.empty()) wire.send(bytes, {wire.interface.broadcast, kUdpPort});
        for (const Ipv4 address : out.settings.to) wire.sendToOne(bytes, {address, kUdpPort});
        syncIsDue_ = syncIsDue_ || out.settings.sync != 0;
    }

    // Broadcast, as the protocol requires.
    void afterTick(DmxWire& wire) override {
        if (std::exchange(syncIsDue_, false)) wire.send(bytesOf(Sync{}), {wire.interface.broadcast, kUdpPort});
    }

    void sendTerminated(DmxWire&, Outgoing&) override {}  // Art-Net has no termination message

    Time poll(DmxWire& wire, Time now) override {
        if (now >= nextPoll_) {
            nextPoll_ = now + kPoll;
            const auto poll = bytesOf(Poll{});
            wire.send(poll, {wire.interface.broadcast, kUdpPort});
            // A router stops broadcasts, and some switches drop them, so each node is also polled
            // directly. The polls leave from our own port, because nodes send their replies there.
            for (const Outgoing* const out : wire.outgoing)
                if (out->settings.polled) (void)wire.socket.send(poll, {out->settings.to.front(), kUdpPort});
        }
        return nextPoll_;
    }

    std::optional<Outage> blockedReason(const Outgoing& out, Time now) override {
        if (!out.settings.polled) return std::nullopt;
        const Ipv4 node = out.settings.to.front();
        const auto heard = heard_.find(node);
        if (heard != heard_.end() && now - heard->second <= kNodeTimeout) return std::nullopt;
        if (heard == heard_.end() && now - began_ <= kNodeTimeout)
            return Outage{DeviceState::Starting, fmt::format("waiting for node {} to answer ArtPoll", textOf(node))};
        return Outage{DeviceState::Absent,
                      fmt::format("node {} does not answer ArtPoll: check its power and network (set poll: false for a node "
                                  "that never answers)",
                                  textOf(node))};
    }

    void receive(DmxWire& wire, std::span<const std::uint8_t> bytes, Endpoint from, Time now) override {
        const auto packet = read(bytes);
        if (!packet) return;
        const bool ours = from.address == wire.interface.address;  // or from another program on this machine
        if (const Dmx* const dmx = std::get_if<Dmx>(&*packet)) {
            const bool sent = std::any_of(wire.outgoing.begin(), wire.outgoing.end(),
                                          [&](const Outgoing* out) { return out->settings.universe == dmx->portAddress; });
            if (ours && sent) return;
            for (Incoming* const in : wire.incoming)
                if (in->universe == dmx->portAddress) receiveLevels(*in, *dmx, from.address, now);
        }
        if (std::holds_alternative<Sync>(*packet)) receiveSync(wire, from.address, now);
        if (std::holds_alternative<Poll>(*packet) && !ours) reply(wire, from.address);
        if (const PollReply* const reply = std::get_if<PollReply>(&*packet)) {
            noteNode(from.address, *reply);
            receiveReply(wire, from.address, now);
        }
    }

private:
    void receiveLevels(Incoming& in, const Dmx& dmx, Ipv4 from, Time now) {
        const Incoming::Key key = keyOf(from);
        const DmxSender* const known = in.find(key, now, kSilence);
        if (known != nullptr && isLate(dmx.sequence, known->sequence)) return;
        DmxSender* const sender = in.findOrAdd(key, now, kSilence);
        if (sender == nullptr) return;
        if (known == nullptr) *sender = {textOf(from), 0, {}, {}};
        sender->sequence = dmx.sequence;
        sender->heard = now;
        DmxInput frame{dmx.slots, sender->source, 100, now, false, kSilence};
        sender->held.reset();
        const auto sync = syncs_.find(from);
        if (sync != syncs_.end() && now - sync->second <= kSyncSilence)
            sender->held = std::move(frame);
        else
            in.put(std::move(frame));
    }

    // A sender's sync packets apply to its own frames only.
    void receiveSync(DmxWire& wire, Ipv4 from, Time now) {
        const Incoming::Key key = keyOf(from);
        bool sends = false;
        for (Incoming* const in : wire.incoming) {
            sends = sends || in->find(key, now, kSilence) != nullptr;
            in->release([&](const Incoming::Key& sender, const DmxSender&) { return sender == key; }, now);
        }
        if (!sends) return;
        std::erase_if(syncs_, [&](const auto& sync) { return now - sync.second > kSyncSilence; });
        syncs_[from] = now;
    }

    void receiveReply(DmxWire& wire, Ipv4 from, Time now) {
        for (const Outgoing* const out : wire.outgoing)
            if (out->settings.polled && out->settings.to.front() == from) heard_[from] = now;
    }

    // One reply per port, because ports of different nets do not fit into one.
    void reply(DmxWire& wire, Ipv4 to) {
        PollReply reply;
        reply.address = wire.interface.address;
        reply.hardware = wire.interface.hardware;
        reply.shortName = "Fantascope";
        reply.longName = "Fantascope, a show controller";
        reply.controller = true;
        const auto sendReply = [&] {
            (void)wire.socket.send(bytesOf(reply), {to, kUdpPort});
            reply.bindIndex = std::min(reply.bindIndex + 1, 255);
        };
        for (const Incoming* const in : wire.incoming) {
            reply.outputs = {in->universe};
            sendReply();
        }
        reply.outputs.clear();
        for (const Outgoing* const out : wire.outgoing) {
            reply.inputs = {out->settings.universe};
            sendReply();
        }
        if (wire.incoming.empty() && wire.outgoing.empty()) sendReply();
    }

    Time began_{}, nextPoll_{};
    bool syncIsDue_ = false;
    std::map<Ipv4, Time> heard_, syncs_;  // the last answer of each node, the last sync packet of each sender
};

std::shared_ptr<DmxNetwork> networkFor(const std::string& interface, const DriverContext& context) {
    static Shared<std::tuple<std::string, Clock*>, DmxNetwork> networks;
    return networks.get({interface, &context.clock}, [&] {
        return std::make_shared<DmxNetwork>(interface, std::make_unique<ArtnetProtocol>(), context.clock);
    });
}

// The keys that both directions have.
struct Keys {
    std::string driver, interface;
    int net = 0, subnet = 0, universe = -1;
};

void declare(ConfigFields& fields, Keys& keys) {
    fields.text("driver", keys.driver);
    fields.optional().text("interface", keys.interface);
    fields.optional().integer("net", keys.net, 0, 127);
    fields.optional().integer("subnet", keys.subnet, 0, 15);
    fields.optional().integer("universe", keys.universe, 0, 15);
}

Result<int> portAddressOf(const Keys& keys, int universe, const ConfigNode& options) {
    if (keys.universe >= 0) return keys.net << 8 | keys.subnet << 4 | keys.universe;
    if (keys.net != 0 || keys.subnet != 0) return options.error("'universe' is missing beside 'net' and 'subnet', 0 to 15");
    if (universe <= kLastPortAddress) return universe;
    return options.error(fmt::format("Art-Net has no port-address {}: choose one with 'net', 'subnet' and 'universe'", universe));
}

}  // namespace

Result<Opening<DmxPort>> ArtnetPort::fromConfig(const ConfigNode& options, int universe) {
    Keys keys;
    std::optional<Ipv4> node;
    bool sync = false, poll = true;
    ConfigFields fields(options);
    declare(fields, keys);
    fields.optional().read(
        "node", node, [](const ConfigNode& value) -> Result<std::optional<Ipv4>> { return std::optional(TRY(ipv4Of(value))); });
    fields.optional().boolean("poll", poll);
    fields.optional().boolean("sync", sync);
    TRY(fields.finish());
    OutgoingSettings settings;
    settings.universe = TRY(portAddressOf(keys, universe, options));
    if (node) settings.to = {*node};
    settings.polled = node && poll;
    settings.sync = sync;
    const Use sent{fmt::format("Art-Net port-address {} towards {}{}", settings.universe,
                               keys.interface.empty() ? "the network" : keys.interface, node ? ", node " + textOf(*node) : ""),
                   ""};
    const auto open = [keys, settings, universe](const DriverContext& context) -> Result<std::unique_ptr<DmxPort>> {
        return std::unique_ptr<DmxPort>(std::make_unique<NetworkDmxPort>(fmt::format("universe {}", universe), keys.driver,
                                                                         settings, networkFor(keys.interface, context)));
    };
    const auto claim = [=] {
        return fmt::format("Art-Net port-address {}{}{}", settings.universe, node ? " of " + textOf(*node) : "",
                           onWhichInterface(keys.interface));
    };
    return Opening<DmxPort>{.open = open, .uses = {sent}, .claim = claim};
}

Result<Opening<DmxSource>> ArtnetSource::fromConfig(const ConfigNode& options, int universe) {
    Keys keys;
    ConfigFields fields(options);
    declare(fields, keys);
    TRY(fields.finish());
    const int portAddress = TRY(portAddressOf(keys, universe, options));
    const auto open = [keys, portAddress, universe](const DriverContext& context) -> Result<std::unique_ptr<DmxSource>> {
        return std::unique_ptr<DmxSource>(std::make_unique<NetworkDmxSource>(fmt::format("desk {}", universe), keys.driver,
                                                                             portAddress, networkFor(keys.interface, context)));
    };
    return Opening<DmxSource>{open};
}

}  // namespace fantascope::drivers
