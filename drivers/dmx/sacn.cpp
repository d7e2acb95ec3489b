#include "drivers/dmx/sacn.h"

#include "drivers/common/shared.h"
#include "drivers/dmx/dmx_network.h"
#include "drivers/dmx/sacn_packet.h"

#include "core/file.h"
#include "core/text.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <tuple>
#include <utility>

namespace fantascope::drivers {
namespace {

using namespace sacn;

// E1.31's timeout for a lost network (section 6.7.1), also for sync packets (section 11.1.2).
constexpr Time kSilence = std::chrono::milliseconds(2500);
constexpr Time kDiscovery = std::chrono::seconds(10);
// All universes of a source are opened within this time, so the first discovery packet lists them
// all.
constexpr Time kFirstDiscovery = std::chrono::seconds(1);
constexpr std::size_t kMaxSyncs = 64;  // a bound, so that a flood of packets cannot exhaust memory

// Sync packets of one sync universe, outgoing and incoming.
struct SyncOut {
    std::uint8_t sequence = 0;
    std::vector<Ipv4> to;  // the unicast devices of this tick
    bool toAll = false;
};
struct SyncIn {
    Membership membership;
    std::optional<Time> heard;
};

class SacnProtocol final : public DmxProtocol {
public:
    explicit SacnProtocol(const Cid& cid) : cid_(cid) {}

    std::uint16_t udpPort() const override { return kUdpPort; }
    void begin(DmxWire&, Time now) override {
        joined_.clear();
        syncsIn_.clear();
        nextDiscovery_ = now + kFirstDiscovery;
    }

    void send(DmxWire& wire, Outgoing& out) override {
        sendLevels(wire, out, false);
        if (out.settings.sync == 0) return;
        SyncOut& sync = syncsOut_[out.settings.sync];
        sync.toAll = sync.toAll || out.settings.to.empty();
        for (const Ipv4 address : out.settings.to)
            if (std::find(sync.to.begin(), sync.to.end(), address) == sync.to.end()) sync.to.push_back(address);
    }

    void afterTick(DmxWire& wire) override {
        for (auto& [universe, sync] : syncsOut_) {
            if (!sync.toAll && sync.to.empty()) continue;
            const SyncBytes bytes = bytesOf(Sync{cid_, sync.sequence++, universe});
            if (std::exchange(sync.toAll, false)) wire.send(bytes, {{groupOf(universe)}, kUdpPort});
            for (const Ipv4 address : sync.to) wire.sendToOne(bytes, {address, kUdpPort});
            sync.to.clear();
        }
    }

    void sendTerminated(DmxWire& wire, Outgoing& out) override {
        for (int time = 0; time < 3; ++time) sendLevels(wire, out, true);
    }

    Time poll(DmxWire& wire, Time now) override {
        joinAll(wire);
        if (now >= nextDiscovery_) {
            discover(wire);
            nextDiscovery_ = now + kDiscovery;
        }
        return nextDiscovery_;
    }

    std::optional<Outage> blockedReason(const Outgoing&, Time) override { return std::nullopt; }

    void receive(DmxWire& wire, std::span<const std::uint8_t> bytes, Endpoint, Time now) override {
        const auto packet = read(bytes);
        if (!packet) return;
        if (const Data* const data = std::get_if<Data>(&*packet); data != nullptr && data->cid != cid_)
            for (Incoming* const in : wire.incoming)
                if (in->universe == data->universe) receiveLevels(wire, *in, *data, now);
        if (const Sync* const sync = std::get_if<Sync>(&*packet)) receiveSync(wire, *sync, now);
    }

private:
    void sendLevels(DmxWire& wire, Outgoing& out, bool last) {
        const OutgoingSettings& settings = out.settings;
        Data data;
        data.cid = cid_;
        data.name = settings.name;
        data.universe = settings.universe;
        data.priority = settings.priority;
        data.sync = settings.sync;
        data.sequence = out.sequence++;
        data.preview = settings.preview;
        data.terminated = last;
        data.force = settings.sync != 0;  // unsynchronised lamps are better than frozen ones
        data.slots = out.slots;
        const DataBytes bytes = bytesOf(data);
        if (settings.to.empty()) wire.send(bytes, {{groupOf(settings.universe)}, kUdpPort});
        for (const Ipv4 address : settings.to) wire.sendToOne(bytes, {address, kUdpPort});
    }

    void discover(DmxWire& wire) {
        std::vector<int> universes;
        std::string name;
        for (const Outgoing* const out : wire.outgoing)
            if (out->active) {
                universes.push_back(out->settings.universe);
                name = out->settings.name;
            }
        if (universes.empty()) return;
        std::sort(universes.begin(), universes.end());
        universes.erase(std::unique(universes.begin(), universes.end()), universes.end());
        const std::size_t pages = (universes.size() + kUniversesOnPage - 1) / kUniversesOnPage;
        for (std::size_t page = 0; page < pages; ++page) {
            const auto first = universes.begin() + static_cast<std::ptrdiff_t>(page * kUniversesOnPage);
            const auto count =
                std::min(static_cast<std::ptrdiff_t>(kUniversesOnPage), static_cast<std::ptrdiff_t>(universes.end() - first));
            wire.send(bytesOf(Discovery{cid_, name, static_cast<int>(page), static_cast<int>(pages) - 1, {first, first + count}}),
                      {{groupOf(kDiscoveryUniverse)}, kUdpPort});
        }
    }

    void joinAll(DmxWire& wire) {
        const auto listened = [&](int universe) {
            return std::any_of(wire.incoming.begin(), wire.incoming.end(),
                               [&](const Incoming* in) { return in->universe == universe; });
        };
        std::erase_if(joined_, [&](const auto& entry) { return !listened(entry.first); });
        for (const Incoming* const in : wire.incoming) {
            if (joined_.contains(in->universe)) continue;
            auto joined = Membership::join(wire.interface, {groupOf(in->universe)});
            if (joined)
                joined_.emplace(in->universe, std::move(*joined));
            else
                wire.trouble = joined.error().message();
        }
    }

    // Whether frames that name this sync universe wait for its packets (section 6.2.4.1). They do
    // not before the first one: many senders name a universe and never send any.
    bool waitsFor(DmxWire& wire, const Data& data, Time now) {
        if (data.sync == 0) return false;
        auto found = syncsIn_.find(data.sync);
        if (found == syncsIn_.end()) {
            if (syncsIn_.size() >= kMaxSyncs) return false;
            auto joined = Membership::join(wire.interface, {groupOf(data.sync)});
            if (!joined) return false;
            found = syncsIn_.emplace(data.sync, SyncIn{std::move(*joined), std::nullopt}).first;
        }
        if (!found->second.heard) return false;
        return now - *found->second.heard <= kSilence || !data.force;
    }

    void receiveLevels(DmxWire& wire, Incoming& in, const Data& data, Time now) {
        if (data.preview || data.startCode != 0) return;
        DmxSender* const known = in.find(data.cid, now, kSilence);
        if (known != nullptr && isLate(data.sequence, known->sequence)) return;
        DmxInput frame{data.slots, "", data.priority, now, data.terminated, kSilence};
        if (data.terminated) {
            if (known == nullptr) return;  // termination is sent three times
            frame.source = known->source;
            in.end(data.cid, std::move(frame));
            return;
        }
        DmxSender* const sender = in.findOrAdd(data.cid, now, kSilence);
        if (sender == nullptr) return;
        if (known == nullptr)
            *sender = {
                data.name.empty() ? textOf(data.cid) : fmt::format("{} {}", printable(data.name), textOf(data.cid)), 0, {}, {}};
        sender->sequence = data.sequence;
        sender->heard = now;
        frame.source = sender->source;
        sender->held.reset();
        if (waitsFor(wire, data, now)) {
            sender->held = std::move(frame);
            sender->heldFor = data.sync;
        } else {
            in.put(std::move(frame));
        }
    }

    void receiveSync(DmxWire& wire, const Sync& sync, Time now) {
        const auto found = syncsIn_.find(sync.universe);
        if (found == syncsIn_.end()) return;
        found->second.heard = now;
        for (Incoming* const in : wire.incoming)
            in->release([&](const Incoming::Key&, const DmxSender& sender) { return sender.heldFor == sync.universe; }, now);
    }

    const Cid cid_;
    std::map<int, Membership> joined_;
    std::map<int, SyncOut> syncsOut_;
    std::map<int, SyncIn> syncsIn_;
    Time nextDiscovery_{};
};

std::string machineName() {
    if (const auto id = readStart("/etc/machine-id", 32)) return *id;
    char name[256] = "";
    gethostname(name, sizeof name - 1);
    return name;
}

std::shared_ptr<DmxNetwork> networkFor(const ConfigNode& options, const std::string& interface, const DriverContext& context) {
    // The same after a restart; another for another site, machine or interface, because each has
    // its own sequence numbers.
    std::error_code relative;
    const std::filesystem::path site = std::filesystem::absolute(options.file(), relative);
    const Cid cid = cidFor(fmt::format("{}\n{}\n{}", machineName(), site.lexically_normal().string(), interface));
    static Shared<std::tuple<std::string, Cid, Clock*>, DmxNetwork> networks;
    return networks.get({interface, cid, &context.clock}, [&] {
        return std::make_shared<DmxNetwork>(interface, std::make_unique<SacnProtocol>(cid), context.clock);
    });
}

void checkUniverse(ConfigFields& fields, const ConfigNode& options, int universe) {
    if (universe < 1 || universe > kLastUniverse)
        fields.check(options, options.error(fmt::format("sACN has the universes 1 to {}, not {}", kLastUniverse, universe)));
}

}  // namespace

Result<Opening<DmxPort>> SacnPort::fromConfig(const ConfigNode& options, int universe) {
    std::string driver, interface;
    OutgoingSettings settings;
    settings.universe = universe;
    settings.name = "Fantascope";
    ConfigFields fields(options);
    fields.text("driver", driver);
    fields.optional().text("interface", interface);
    fields.optional().integer("priority", settings.priority, 0, 200);
    fields.optional().list(
        "unicast", settings.to, [](const ConfigNode& node) { return ipv4Of(node); }, 1, 100);
    fields.optional().integer("sync", settings.sync, 1, kLastUniverse);
    fields.optional().boolean("preview", settings.preview);
    fields.optional().text("name", settings.name);
    if (settings.name.size() >= kNameSize)
        fields.check(options,
                     options.error(fmt::format("'name' is {} bytes long, {} are the most", settings.name.size(), kNameSize - 1)));
    checkUniverse(fields, options, universe);
    TRY(fields.finish());
    const auto open = [=](const DriverContext& context) -> Result<std::unique_ptr<DmxPort>> {
        return std::unique_ptr<DmxPort>(std::make_unique<NetworkDmxPort>(fmt::format("universe {}", universe), driver, settings,
                                                                         networkFor(options, interface, context)));
    };
    const auto claim = [=] { return fmt::format("sACN universe {}{}", universe, onWhichInterface(interface)); };
    return Opening<DmxPort>{.open = open, .claim = claim};
}

Result<Opening<DmxSource>> SacnSource::fromConfig(const ConfigNode& options, int universe) {
    std::string driver, interface;
    ConfigFields fields(options);
    fields.text("driver", driver);
    fields.optional().text("interface", interface);
    checkUniverse(fields, options, universe);
    TRY(fields.finish());
    const auto open = [=](const DriverContext& context) -> Result<std::unique_ptr<DmxSource>> {
        return std::unique_ptr<DmxSource>(std::make_unique<NetworkDmxSource>(fmt::format("desk {}", universe), driver, universe,
                                                                             networkFor(options, interface, context)));
    };
    return Opening<DmxSource>{open};
}

}  // namespace fantascope::drivers
