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

// How often a wire is looked at: well within a person's patience.
constexpr Time kLook = std::chrono::milliseconds(100);

// No datagram of either protocol is longer than an Ethernet frame.
constexpr std::size_t kLongestDatagram = 1500;

// More than that are left for the next round, so that a flood never keeps levels from going out.
constexpr int kMostAtOnce = 1000;

// Some microseconds of work a tick that lamps show when they are late: it goes before everything,
// where the system allows that even before the pictures
// (docs/decisions/0007-rendering-has-real-time-priority.md), whose threads may each keep a core for
// a tenth of a second.
void goFirst() {
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
    status_ = {std::move(name), std::move(driver), DeviceState::Starting, LossAction::Hold, "the network is being looked for", 0};
}

DeviceStatus UniverseStatus::status() const {
    const std::lock_guard lock(mutex_);
    return status_;
}

Error UniverseStatus::refusal() const {
    const DeviceStatus now = status();
    return Error(now.name + " is " + nameOf(now.state) + (now.detail.empty() ? "" : ": " + now.detail));
}

void UniverseStatus::run() {
    const std::lock_guard lock(mutex_);
    status_.state = DeviceState::Running;
    status_.detail.clear();
    running_ = true;
}

void UniverseStatus::lose(const Outage& outage) {
    const std::lock_guard lock(mutex_);
    if (status_.state == DeviceState::Running) ++status_.losses;
    status_.state = outage.state;
    status_.detail = outage.why;
    running_ = false;
}

void Outgoing::hand(std::span<const std::uint8_t, kDmxSlots> slots) {
    std::copy(slots.begin(), slots.end(), wanted_.writable().begin());
    wanted_.publish();
    fresh_ = true;
}

bool Outgoing::takeChange() {
    if (!fresh_.exchange(false) || !wanted_.update() || (speaks && wanted_.value() == slots)) return false;
    slots = wanted_.value();
    speaks = true;
    repeats_ = DmxNetwork::kRepeats;
    return true;
}

bool Outgoing::isDue(Time now) {
    if (takeChange()) {
        sent_ = now;
        return true;
    }
    if (!speaks || now < *nextDue()) return false;
    repeats_ = std::max(repeats_ - 1, 0);
    sent_ = now;
    return true;
}

bool Outgoing::isOwed() {
    if (takeChange()) return true;
    if (!speaks || repeats_ == 0) return false;
    --repeats_;
    return true;
}

std::optional<Time> Outgoing::nextDue() const {
    if (!speaks) return std::nullopt;
    return repeats_ > 0 ? tickAfter(sent_) : sent_ + DmxNetwork::kKeepAlive;
}

void Outgoing::forget() {
    fresh_ = false;
    wanted_.update();
    speaks = false;
}

std::optional<DmxInput> Incoming::take() {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return std::nullopt;
    DmxInput oldest = std::move(waiting_.front());
    waiting_.pop_front();
    return oldest;
}

DmxSender* Incoming::known(const Key& key, Time now, Time silence) {
    const auto found = senders_.find(key);
    if (found == senders_.end() || now - found->second.heard > silence) return nullptr;
    return &found->second;
}

DmxSender* Incoming::met(const Key& key, Time now, Time silence) {
    if (DmxSender* sender = known(key, now, silence)) return sender;
    std::erase_if(senders_, [&](const auto& entry) { return now - entry.second.heard > silence; });
    return senders_.size() < kMostSenders ? &senders_[key] : nullptr;
}

void Incoming::put(DmxInput frame) {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(frame));
    if (waiting_.size() <= kDepth) return;
    // The oldest frame that its own sender has already replaced; every sender's newest stays.
    for (auto old = waiting_.begin(); old != waiting_.end(); ++old) {
        if (std::none_of(old + 1, waiting_.end(), [&](const DmxInput& later) { return later.source == old->source; })) continue;
        waiting_.erase(old);
        return;
    }
    // Every one is somebody's only one: as many senders may have spoken as we ever know at once.
    if (waiting_.size() > kDepth + kMostSenders) waiting_.pop_front();
}

void Incoming::end(const Key& key, DmxInput goodbye) {
    senders_.erase(key);
    put(std::move(goodbye));
}

void Incoming::forget() {
    senders_.clear();
    const std::lock_guard lock(mutex_);
    waiting_.clear();
}

void DmxWire::send(std::span<const std::uint8_t> bytes, Endpoint to) {
    if (const int error = socket.send(bytes, to); error != 0)
        trouble = fmt::format("{} takes nothing for {}: {}", interface.name, textOf(to.address), systemMessage(error));
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
    // Whether anybody is there shows elsewhere, if at all.
    (void)found->second.send(bytes, to);
}

DmxNetwork::DmxNetwork(std::string interface, std::unique_ptr<DmxProtocol> protocol, Clock& clock)
    : interface_(std::move(interface)),
      protocol_(std::move(protocol)),
      clock_(clock),
      service_("network", "udp", LossAction::Hold, [this](Service& service) { return attend(service); }) {}

void DmxNetwork::add(Outgoing& out) {
    {
        const std::lock_guard lock(mutex_);
        wire_.outgoing.push_back(&out);
        nextLook_ = {};  // before it is said to run
    }
    service_.call();
}

void DmxNetwork::add(Incoming& in) {
    {
        const std::lock_guard lock(mutex_);
        wire_.incoming.push_back(&in);
        nextLook_ = {};
    }
    service_.call();
}

void DmxNetwork::remove(Outgoing& out) {
    const std::lock_guard lock(mutex_);
    // Receivers ignore the levels of a goodbye (ANSI E1.31, section 6.2.6), and Art-Net knows none.
    while (there_ && out.isOwed()) {
        protocol_->send(wire_, out);
        protocol_->afterTick(wire_);
    }
    if (there_ && out.speaks) protocol_->sayGoodbye(wire_, out);
    std::erase(wire_.outgoing, &out);
}

void DmxNetwork::remove(Incoming& in) {
    const std::lock_guard lock(mutex_);
    std::erase(wire_.incoming, &in);
}

void DmxNetwork::call() {
    if (idle_.exchange(false)) service_.call();
}

Outage DmxNetwork::attend(Service& service) {
    goFirst();
    Outage outage = serve(service);
    const std::lock_guard lock(mutex_);
    there_ = false;
    wire_.toOne.clear();
    wire_.socket = {};
    for (Outgoing* const out : wire_.outgoing) {
        out->status.lose(outage);
        out->forget();
    }
    for (Incoming* const in : wire_.incoming) {
        in->status.lose(outage);
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
        there_ = true;
        protocol_->begin(wire_, clock_.now());
        nextTick_ = clock_.now();
    }
    service.running();
    while (!service.ending()) {
        Time due;
        int file;
        {
            const std::lock_guard lock(mutex_);
            receiveAll(clock_.now());
            const Time now = clock_.now();
            if (now >= nextLook_ || !wire_.trouble.empty()) {
                NetworkInterface seen;
                if (auto why = whyNoInterface(interface_, seen)) return *why;
                if (seen != wire_.interface) return {DeviceState::Absent, fmt::format("{} has another address", seen.name)};
                if (!wire_.trouble.empty()) return {DeviceState::Faulted, wire_.trouble};
                nextLook_ = now + kLook;
            }
            for (Incoming* const in : wire_.incoming)
                if (!in->status.isRunning()) in->status.run();
            for (Outgoing* const out : wire_.outgoing) {
                if (auto why = protocol_->hindrance(*out, now)) {
                    out->status.lose(*why);
                    out->forget();
                } else if (!out->status.isRunning()) {
                    out->forget();
                    out->status.run();
                }
            }
            if (now >= nextTick_) tick(now);
            due = std::min(protocol_->tend(wire_, now), nextLook_);
            // Whoever hands over levels from now on calls; what was handed over before is seen
            // here.
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
    std::array<std::uint8_t, kLongestDatagram> buffer;
    for (int count = 0; count < kMostAtOnce; ++count) {
        Endpoint from;
        const auto size = wire_.socket.receive(buffer, from);
        if (!size) return;
        protocol_->receive(wire_, std::span(buffer).first(*size), from, now);
    }
}

void DmxNetwork::tick(Time now) {
    bool sent = false;
    for (Outgoing* const out : wire_.outgoing) {
        if (!out->status.isRunning() || !out->isDue(now)) continue;
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
    // The tick at or after what is due.
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
    out_.hand(slots);
    network_->call();
    return {};
}

NetworkDmxSource::NetworkDmxSource(std::string name, std::string driver, int universe, std::shared_ptr<DmxNetwork> network)
    : network_(std::move(network)), in_(std::move(name), std::move(driver), universe) {
    network_->add(in_);
}

NetworkDmxSource::~NetworkDmxSource() { network_->remove(in_); }

}  // namespace fantascope::drivers
