#include "drivers/dmx/dmx_network.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

namespace fantascope::drivers {
namespace {

// How often the interface is checked; short for a person who waits.
constexpr Time kLinkCheck = std::chrono::milliseconds(100);

// Bytes; no datagram of either protocol is longer than an Ethernet frame.
constexpr std::size_t kMaxDatagram = 1500;

// Datagrams; the rest waits for the next round, so that a flood cannot delay the levels.
constexpr int kMaxPerRound = 1000;

// Raises the thread's priority as far as the system allows, even above the threads that draw
// pictures, each of which may keep a core for a tenth of a second
// (docs/decisions/0007-rendering-has-real-time-priority.md). A tick takes microseconds, and lamps
// show when it is late.
void raisePriority() {
    prctl(PR_SET_TIMERSLACK, 1UL);
    for (const int priority : {2, 1}) {
        const sched_param realTime{.sched_priority = priority};
        if (sched_setscheduler(0, SCHED_RR, &realTime) == 0) return;
    }
    setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), -10);
}

Time tickAfter(Time time) { return tickTime(tickAt(time, DmxNetwork::kRate) + 1, DmxNetwork::kRate); }

}  // namespace

UniverseStatus::UniverseStatus(std::string name, std::string driver) {
    status_ = {std::move(name), std::move(driver), DeviceState::Starting, LossAction::Hold, "looking for the network", 0};
}

DeviceStatus UniverseStatus::status() const {
    const std::lock_guard lock(mutex_);
    return status_;
}

Error UniverseStatus::refusal() const {
    const DeviceStatus now = status();
    return Error(now.name + " is " + nameOf(now.state) + (now.detail.empty() ? "" : ": " + now.detail));
}

void UniverseStatus::setRunning() {
    const std::lock_guard lock(mutex_);
    status_.state = DeviceState::Running;
    status_.detail.clear();
    running_ = true;
}

void UniverseStatus::setLost(const Outage& outage) {
    const std::lock_guard lock(mutex_);
    if (status_.state == DeviceState::Running) ++status_.losses;
    status_.state = outage.state;
    status_.detail = outage.why;
    running_ = false;
}

void Outgoing::setLevels(std::span<const std::uint8_t, kDmxSlots> slots) {
    std::copy(slots.begin(), slots.end(), wanted_.writable().begin());
    wanted_.publish();
    fresh_ = true;
}

bool Outgoing::takeChange() {
    if (!fresh_.exchange(false) || !wanted_.update() || (active && wanted_.value() == slots)) return false;
    slots = wanted_.value();
    active = true;
    repeats_ = DmxNetwork::kRepeats;
    return true;
}

bool Outgoing::takeDue(Time now) {
    if (takeChange()) {
        sent_ = now;
        return true;
    }
    if (!active || now < *nextDue()) return false;
    repeats_ = std::max(repeats_ - 1, 0);
    sent_ = now;
    return true;
}

bool Outgoing::takePending() {
    if (takeChange()) return true;
    if (!active || repeats_ == 0) return false;
    --repeats_;
    return true;
}

std::optional<Time> Outgoing::nextDue() const {
    if (!active) return std::nullopt;
    return repeats_ > 0 ? tickAfter(sent_) : sent_ + DmxNetwork::kKeepAlive;
}

void Outgoing::forget() {
    fresh_ = false;
    wanted_.update();
    active = false;
}

std::optional<DmxInput> Incoming::take() {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return std::nullopt;
    DmxInput oldest = std::move(waiting_.front());
    waiting_.pop_front();
    return oldest;
}

DmxSender* Incoming::find(const Key& key, Time now, Time silence) {
    const auto found = senders_.find(key);
    if (found == senders_.end() || now - found->second.heard > silence) return nullptr;
    return &found->second;
}

DmxSender* Incoming::findOrAdd(const Key& key, Time now, Time silence) {
    if (DmxSender* sender = find(key, now, silence)) return sender;
    std::erase_if(senders_, [&](const auto& entry) { return now - entry.second.heard > silence; });
    return senders_.size() < kMaxSenders ? &senders_[key] : nullptr;
}

void Incoming::put(DmxInput frame) {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(frame));
    if (waiting_.size() <= kDepth) return;
    // Drops the oldest frame that its own sender has already replaced. The newest of every sender
    // stays.
    for (auto old = waiting_.begin(); old != waiting_.end(); ++old) {
        if (std::none_of(old + 1, waiting_.end(), [&](const DmxInput& later) { return later.source == old->source; })) continue;
        waiting_.erase(old);
        return;
    }
    // Every frame is its sender's only one. As many senders may have sent as we track at once.
    if (waiting_.size() > kDepth + kMaxSenders) waiting_.pop_front();
}

void Incoming::end(const Key& key, DmxInput terminated) {
    senders_.erase(key);
    put(std::move(terminated));
}

void Incoming::forget() {
    senders_.clear();
    const std::lock_guard lock(mutex_);
    waiting_.clear();
}

void DmxWire::send(std::span<const std::uint8_t> bytes, Endpoint to) {
    if (const int error = socket.send(bytes, to); error != 0)
        trouble = fmt::format("{} cannot send to {}: {}", interface.name, textOf(to.address), systemMessage(error));
}

void DmxWire::sendToOne(std::span<const std::uint8_t> bytes, Endpoint to) {
    auto found = toOne.find(to.address);
    if (found == toOne.end()) {
        auto opened = UdpSocket::open(interface, 0);
        if (!opened) {
            trouble = opened.error().message();
            return;
        }
        found = toOne.emplace(to.address, std::move(*opened)).first;
    }
    // Whether the device is there shows elsewhere, if at all.
    (void)found->second.send(bytes, to);
}

DmxNetwork::DmxNetwork(std::string interface, std::unique_ptr<DmxProtocol> protocol, Clock& clock)
    : interface_(std::move(interface)),
      protocol_(std::move(protocol)),
      clock_(clock),
      service_("network", "udp", LossAction::Hold, [this](Service& service) { return runOnce(service); }) {}

void DmxNetwork::add(Outgoing& out) {
    {
        const std::lock_guard lock(mutex_);
        wire_.outgoing.push_back(&out);
        nextLinkCheck_ = {};  // checked before it counts as Running
    }
    service_.wake();
}

void DmxNetwork::add(Incoming& in) {
    {
        const std::lock_guard lock(mutex_);
        wire_.incoming.push_back(&in);
        nextLinkCheck_ = {};
    }
    service_.wake();
}

void DmxNetwork::remove(Outgoing& out) {
    const std::lock_guard lock(mutex_);
    // Receivers ignore the levels of a terminating packet (ANSI E1.31, section 6.2.6), and Art-Net
    // has none.
    while (connected_ && out.takePending()) {
        protocol_->send(wire_, out);
        protocol_->afterTick(wire_);
    }
    if (connected_ && out.active) protocol_->sendTerminated(wire_, out);
    std::erase(wire_.outgoing, &out);
}

void DmxNetwork::remove(Incoming& in) {
    const std::lock_guard lock(mutex_);
    std::erase(wire_.incoming, &in);
}

void DmxNetwork::wake() {
    if (idle_.exchange(false)) service_.wake();
}

Outage DmxNetwork::runOnce(Service& service) {
    raisePriority();
    Outage outage = serve(service);
    const std::lock_guard lock(mutex_);
    connected_ = false;
    wire_.toOne.clear();
    wire_.socket = {};
    for (Outgoing* const out : wire_.outgoing) {
        out->status.setLost(outage);
        out->forget();
    }
    for (Incoming* const in : wire_.incoming) {
        in->status.setLost(outage);
        in->forget();
    }
    return outage;
}

Outage DmxNetwork::serve(Service& service) {
    {
        const std::lock_guard lock(mutex_);
        if (auto why = whyNoInterface(interface_, wire_.interface)) return *why;
        auto socket = UdpSocket::open(wire_.interface, protocol_->udpPort());
        if (!socket) return {DeviceState::Faulted, socket.error().message()};
        wire_.socket = std::move(*socket);
        wire_.trouble.clear();
        for (Outgoing* const out : wire_.outgoing) out->forget();
        connected_ = true;
        protocol_->begin(wire_, clock_.now());
        nextTick_ = clock_.now();
    }
    service.setRunning();
    while (!service.ending()) {
        Time due;
        int file;
        {
            const std::lock_guard lock(mutex_);
            receiveAll(clock_.now());
            const Time now = clock_.now();
            if (now >= nextLinkCheck_ || !wire_.trouble.empty()) {
                NetworkInterface seen;
                if (auto why = whyNoInterface(interface_, seen)) return *why;
                if (seen != wire_.interface) return {DeviceState::Absent, fmt::format("{} has a new address", seen.name)};
                if (!wire_.trouble.empty()) return {DeviceState::Faulted, wire_.trouble};
                nextLinkCheck_ = now + kLinkCheck;
            }
            for (Incoming* const in : wire_.incoming)
                if (!in->status.isRunning()) in->status.setRunning();
            for (Outgoing* const out : wire_.outgoing) {
                if (auto why = protocol_->blockedReason(*out, now)) {
                    out->status.setLost(*why);
                    out->forget();
                } else if (!out->status.isRunning()) {
                    out->forget();
                    out->status.setRunning();
                }
            }
            if (now >= nextTick_) tick(now);
            due = std::min(protocol_->poll(wire_, now), nextLinkCheck_);
            // Levels that are set from now on wake this thread. Levels that were set before are
            // seen here.
            idle_ = true;
            nextTick_ = nextTick(now);
            if (nextTick_ <= tickAfter(now)) idle_ = false;
            due = std::min(due, nextTick_);
            file = wire_.socket.file();
        }
        service.wait(due - clock_.now(), {file});
    }
    return {};
}

void DmxNetwork::receiveAll(Time now) {
    std::array<std::uint8_t, kMaxDatagram> buffer;
    for (int count = 0; count < kMaxPerRound; ++count) {
        Endpoint from;
        const auto size = wire_.socket.receive(buffer, from);
        if (!size) return;
        protocol_->receive(wire_, std::span(buffer).first(*size), from, now);
    }
}

void DmxNetwork::tick(Time now) {
    bool sent = false;
    for (Outgoing* const out : wire_.outgoing) {
        if (!out->status.isRunning() || !out->takeDue(now)) continue;
        protocol_->send(wire_, *out);
        sent = true;
    }
    if (sent) protocol_->afterTick(wire_);
}

Time DmxNetwork::nextTick(Time now) const {
    const Time soonest = tickAfter(now);
    Time next = now + kKeepAlive;
    for (Outgoing* const out : wire_.outgoing) {
        if (out->isFresh()) return soonest;
        if (const auto due = out->nextDue()) next = std::min(next, *due);
    }
    // The first tick at or after that time.
    return std::max(soonest, tickAfter(next - Time(1)));
}

NetworkDmxPort::NetworkDmxPort(std::string name, std::string driver, OutgoingSettings settings,
                               std::shared_ptr<DmxNetwork> network)
    : network_(std::move(network)), out_(std::move(name), std::move(driver), std::move(settings)) {
    network_->add(out_);
}

NetworkDmxPort::~NetworkDmxPort() { network_->remove(out_); }

Result<void> NetworkDmxPort::send(std::span<const std::uint8_t, kDmxSlots> slots) {
    if (!out_.status.isRunning()) return out_.status.refusal();
    out_.setLevels(slots);
    network_->wake();
    return {};
}

NetworkDmxSource::NetworkDmxSource(std::string name, std::string driver, int universe, std::shared_ptr<DmxNetwork> network)
    : network_(std::move(network)), in_(std::move(name), std::move(driver), universe) {
    network_->add(in_);
}

NetworkDmxSource::~NetworkDmxSource() { network_->remove(in_); }

}  // namespace fantascope::drivers
