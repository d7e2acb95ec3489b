#pragma once

#include "drivers/common/service.h"
#include "drivers/dmx/udp_socket.h"

#include "device/dmx_port.h"
#include "device/dmx_source.h"

#include "core/clock.h"
#include "core/latest_value.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace fantascope::drivers {

using DmxSlots = std::array<std::uint8_t, kDmxSlots>;

// What one universe on a network says of itself. Thread: thread-safe.
class UniverseStatus {
public:
    UniverseStatus(std::string name, std::string driver);

    DeviceStatus status() const;
    bool isRunning() const { return running_; }
    Error refusal() const;  // of a call while it is not Running
    void run();
    void lose(const Outage& outage);

private:
    mutable std::mutex mutex_;
    DeviceStatus status_;
    std::atomic<bool> running_ = false;
};

// How a universe goes out; a protocol leaves what it has no use for.
struct OutgoingSettings {
    int universe = 1;      // of sACN, or the port-address of Art-Net
    std::vector<Ipv4> to;  // one by one; empty: to all, by multicast or broadcast
    bool polled = false;   // Art-Net: whoever is not answering polls is not there
    int priority = 100;    // sACN
    int sync = 0;          // the universe of the sync packets (sACN), or 1 (Art-Net); 0: none
    bool preview = false;  // sACN
    std::string name;      // sACN: of the source
};

// One universe going out. The lighting thread hands over frames, the network's thread sends them.
class Outgoing {
public:
    Outgoing(std::string name, std::string driver, OutgoingSettings settings)
        : status(std::move(name), std::move(driver)), settings(std::move(settings)) {}

    UniverseStatus status;
    const OutgoingSettings settings;

    void hand(std::span<const std::uint8_t, kDmxSlots> slots);  // on the lighting thread

    // For the network's thread.
    bool isFresh() const { return fresh_; }
    // Whether there is something to send at a tick: new levels, one of the three repeats after
    // them, or the keep-alive.
    bool isDue(Time now);
    // Whether the newest levels, or one of their repeats, are still to be sent; each call counts as
    // sending one.
    bool isOwed();
    // When there is something to send next, unless new levels come.
    std::optional<Time> nextDue() const;
    // What was handed over so far is not sent any more.
    void forget();

    DmxSlots slots{};  // what is sent
    std::uint8_t sequence = 0;
    bool speaks = false;  // slots were handed over since the device came

private:
    bool takeChange();  // new levels into `slots`

    LatestValue<DmxSlots> wanted_;
    std::atomic<bool> fresh_ = false;
    int repeats_ = 0;
    Time sent_{};
};

// Somebody who sends a universe to us.
struct DmxSender {
    std::string source;
    std::uint8_t sequence = 0;
    Time heard{};
    std::optional<DmxInput> held;  // waits for a sync packet
    int heldFor = 0;               // the universe of that
};

// One universe coming in. The network's thread puts frames in, the lighting thread takes them.
class Incoming {
public:
    using Key = std::array<std::uint8_t, 16>;                     // a sender's CID, or its address
    static constexpr std::size_t kDepth = 16, kMostSenders = 64;  // no flood of strangers takes our memory

    Incoming(std::string name, std::string driver, int universe)
        : status(std::move(name), std::move(driver)), universe(universe) {}

    UniverseStatus status;
    const int universe;

    std::optional<DmxInput> take();  // on the lighting thread

    // For the network's thread.
    // The sender of that key if it was heard within `silence`; else null.
    DmxSender* known(const Key& key, Time now, Time silence);
    // The same, but a sender that was not known gets its place. Null: there is none left.
    DmxSender* met(const Key& key, Time now, Time silence);
    void put(DmxInput frame);
    void end(const Key& key, DmxInput goodbye);
    // Everybody whose frame waits gives it.
    template <class Released>
    void release(Released released, Time now) {
        for (auto& [key, sender] : senders_)
            if (sender.held && released(key, sender)) {
                sender.held->arrived = now;
                put(std::move(*sender.held));
                sender.held.reset();
            }
    }
    void forget();

private:
    std::map<Key, DmxSender> senders_;
    std::mutex mutex_;
    std::deque<DmxInput> waiting_;
};

// What there is while the interface is: an open socket for the protocol's port, and one for each
// device that is spoken to alone, because datagrams to one that is off wait in its socket for the
// device's hardware address and take up all the room.
struct DmxWire {
    NetworkInterface interface;
    UdpSocket socket;
    std::map<Ipv4, UdpSocket> toOne;
    std::vector<Outgoing*> outgoing;
    std::vector<Incoming*> incoming;
    std::string trouble;  // why the interface does not take what is sent; empty: it does

    void send(std::span<const std::uint8_t> bytes, Endpoint to);       // to all, from the protocol's own port
    void sendToOne(std::span<const std::uint8_t> bytes, Endpoint to);  // nobody else waits for that one
};

// One protocol on one wire. All calls come while the wire is there, one at a time.
class DmxProtocol {
public:
    virtual ~DmxProtocol() = default;
    virtual std::uint16_t udpPort() const = 0;
    virtual void begin(DmxWire& wire, Time now) = 0;  // the wire has just come; universes may come and go later
    virtual void send(DmxWire& wire, Outgoing& out) = 0;
    virtual void afterTick(DmxWire& wire) = 0;  // all that a tick sends was sent
    virtual void sayGoodbye(DmxWire& wire, Outgoing& out) = 0;
    // Does what is due besides levels, and says when it has something to do next.
    virtual Time tend(DmxWire& wire, Time now) = 0;
    // Why a universe cannot be sent just now, although the wire is there.
    virtual std::optional<Outage> hindrance(const Outgoing& out, Time now) = 0;
    virtual void receive(DmxWire& wire, std::span<const std::uint8_t> bytes, Endpoint from, Time now) = 0;
};

// All universes of one protocol on one interface, with one thread. While levels change they go out
// at the ticks of a train of kRate from the clock's zero, all universes together; a late tick is
// made up for at once and the train stays as it is.
// Thread: all methods may be called from any.
class DmxNetwork {
public:
    static constexpr double kRate = 44;  // Hz: what a DMX512 line carries
    static constexpr int kRepeats = 3;
    static constexpr Time kKeepAlive = std::chrono::milliseconds(900);

    // `interface`: as whyNoInterface() takes it.
    DmxNetwork(std::string interface, std::unique_ptr<DmxProtocol> protocol, Clock& clock);

    void add(Outgoing& out);
    void add(Incoming& in);
    // What is owed to a universe is sent, and goodbyes are said, before these return.
    void remove(Outgoing& out);
    void remove(Incoming& in);
    // There are new levels.
    void call();

private:
    Outage attend(Service& service);
    Outage serve(Service& service);
    void receiveAll(Time now);
    void tick(Time now);
    Time nextTick(Time now) const;

    const std::string interface_;
    const std::unique_ptr<DmxProtocol> protocol_;
    Clock& clock_;
    std::mutex mutex_;  // of wire_ and protocol_
    DmxWire wire_;
    bool there_ = false;              // the wire is
    Time nextLook_{};                 // at the interface
    Time nextTick_{};                 // when the thread gets up to send
    std::atomic<bool> idle_ = false;  // it sleeps for longer than a tick
    Service service_;
};

// A universe that goes out over a network.
class NetworkDmxPort final : public DmxPort {
public:
    NetworkDmxPort(std::string name, std::string driver, OutgoingSettings settings, std::shared_ptr<DmxNetwork> network);
    ~NetworkDmxPort() override;

    DeviceStatus status() const override { return out_.status.status(); }
    Result<void> send(std::span<const std::uint8_t, kDmxSlots> slots) override;

private:
    std::shared_ptr<DmxNetwork> network_;
    Outgoing out_;
};

// A universe that comes in from a network.
class NetworkDmxSource final : public DmxSource {
public:
    NetworkDmxSource(std::string name, std::string driver, int universe, std::shared_ptr<DmxNetwork> network);
    ~NetworkDmxSource() override;

    DeviceStatus status() const override { return in_.status.status(); }
    std::optional<DmxInput> receive() override { return in_.take(); }

private:
    std::shared_ptr<DmxNetwork> network_;
    Incoming in_;
};

}  // namespace fantascope::drivers
