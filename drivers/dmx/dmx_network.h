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

// The status of one universe on a network. Thread: thread-safe.
class UniverseStatus {
public:
    UniverseStatus(std::string name, std::string driver);

    DeviceStatus status() const;
    bool isRunning() const { return running_; }
    Error refusal() const;  // the error of a call while it is not Running
    void setRunning();
    void setLost(const Outage& outage);

private:
    mutable std::mutex mutex_;
    DeviceStatus status_;
    std::atomic<bool> running_ = false;
};

// How a universe is sent; a protocol ignores what it does not use.
struct OutgoingSettings {
    int universe = 1;      // sACN's universe, or Art-Net's port-address
    std::vector<Ipv4> to;  // unicast to each; empty: multicast or broadcast
    bool polled = false;   // Art-Net: the node is Absent unless it answers polls
    int priority = 100;    // sACN
    int sync = 0;          // sACN: the universe of the sync packets; Art-Net: 1; 0: none
    bool preview = false;  // sACN
    std::string name;      // sACN: the source's name
};

// One outgoing universe. The lighting thread sets its levels, the network's thread sends them.
class Outgoing {
public:
    Outgoing(std::string name, std::string driver, OutgoingSettings settings)
        : status(std::move(name), std::move(driver)), settings(std::move(settings)) {}

    UniverseStatus status;
    const OutgoingSettings settings;

    void setLevels(std::span<const std::uint8_t, kDmxSlots> slots);  // on the lighting thread

    // For the network's thread.
    bool isFresh() const { return fresh_; }
    // Takes the frame of this tick: new levels, one of the three repeats after them, or the
    // keep-alive. False: nothing must be sent.
    bool takeDue(Time now);
    // Takes the next unsent frame before the port closes: the newest levels, or one of their
    // repeats. False: nothing is left.
    bool takePending();
    // When something must be sent next, unless new levels come.
    std::optional<Time> nextDue() const;
    // Drops all levels that were set so far.
    void forget();

    DmxSlots slots{};  // what is being sent
    std::uint8_t sequence = 0;
    bool active = false;  // levels were set since the device appeared

private:
    bool takeChange();  // copies new levels to `slots`

    LatestValue<DmxSlots> wanted_;
    std::atomic<bool> fresh_ = false;
    int repeats_ = 0;
    Time sent_{};
};

// A sender of a universe.
struct DmxSender {
    std::string source;
    std::uint8_t sequence = 0;
    Time heard{};
    std::optional<DmxInput> held;  // until a sync packet releases it
    int heldFor = 0;               // the universe of that sync packet
};

// One incoming universe. The network's thread puts frames in, the lighting thread takes them.
class Incoming {
public:
    using Key = std::array<std::uint8_t, 16>;                    // a sender's CID or address
    static constexpr std::size_t kDepth = 16, kMaxSenders = 64;  // bounds, so that a flood of packets cannot exhaust memory

    Incoming(std::string name, std::string driver, int universe)
        : status(std::move(name), std::move(driver)), universe(universe) {}

    UniverseStatus status;
    const int universe;

    std::optional<DmxInput> take();  // on the lighting thread

    // For the network's thread.
    // The sender with this key, if it was heard within `silence`; else null.
    DmxSender* find(const Key& key, Time now, Time silence);
    // The same, but adds an unknown sender. Null: there is no room for another.
    DmxSender* findOrAdd(const Key& key, Time now, Time silence);
    void put(DmxInput frame);
    void end(const Key& key, DmxInput terminated);
    // Releases the waiting frames for which released(key, sender) holds.
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

// What exists while the interface is up: a socket on the protocol's port, and one per unicast
// device. The latter, because datagrams to a device that is off wait in their socket for the
// device's hardware address and would fill a shared one.
struct DmxWire {
    NetworkInterface interface;
    UdpSocket socket;
    std::map<Ipv4, UdpSocket> toOne;
    std::vector<Outgoing*> outgoing;
    std::vector<Incoming*> incoming;
    std::string trouble;  // why the interface refuses to send; empty: it does not

    void send(std::span<const std::uint8_t> bytes, Endpoint to);       // to all, from the protocol's own port
    void sendToOne(std::span<const std::uint8_t> bytes, Endpoint to);  // delays no other device
};

// One protocol on one wire. It is called only while the wire exists, by one thread at a time.
class DmxProtocol {
public:
    virtual ~DmxProtocol() = default;
    virtual std::uint16_t udpPort() const = 0;
    virtual void begin(DmxWire& wire, Time now) = 0;  // the wire is new; universes are added and removed later
    virtual void send(DmxWire& wire, Outgoing& out) = 0;
    virtual void afterTick(DmxWire& wire) = 0;  // everything of this tick was sent
    virtual void sendTerminated(DmxWire& wire, Outgoing& out) = 0;
    // Does its periodic work besides levels, and returns when to call it next.
    virtual Time poll(DmxWire& wire, Time now) = 0;
    // Why a universe cannot be sent now, although the wire exists; nothing: it can.
    virtual std::optional<Outage> blockedReason(const Outgoing& out, Time now) = 0;
    virtual void receive(DmxWire& wire, std::span<const std::uint8_t> bytes, Endpoint from, Time now) = 0;
};

// All universes of one protocol on one interface, with one thread. While levels change, they are
// sent at the ticks of a steady kRate counted from the clock's zero, all universes at the same
// tick. A late tick is sent at once; the next ticks stay in place.
// Thread: thread-safe.
class DmxNetwork {
public:
    static constexpr double kRate = 44;  // Hz, as on a DMX512 line
    static constexpr int kRepeats = 3;
    static constexpr Time kKeepAlive = std::chrono::milliseconds(900);

    // `interface`: as for whyNoInterface().
    DmxNetwork(std::string interface, std::unique_ptr<DmxProtocol> protocol, Clock& clock);

    void add(Outgoing& out);
    void add(Incoming& in);
    // Before they return, pending frames of the universe are sent and its stream is terminated.
    void remove(Outgoing& out);
    void remove(Incoming& in);
    // Call after new levels were set.
    void wake();

private:
    Outage runOnce(Service& service);
    Outage serve(Service& service);
    void receiveAll(Time now);
    void tick(Time now);
    Time nextTick(Time now) const;

    const std::string interface_;
    const std::unique_ptr<DmxProtocol> protocol_;
    Clock& clock_;
    std::mutex mutex_;  // guards wire_ and protocol_
    DmxWire wire_;
    bool connected_ = false;          // the wire exists
    Time nextLinkCheck_{};            // of the interface
    Time nextTick_{};                 // when the thread wakes to send
    std::atomic<bool> idle_ = false;  // it sleeps for longer than one tick
    Service service_;
};

// A universe sent over a network.
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

// A universe received from a network.
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
