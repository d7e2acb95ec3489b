#include "app/live/lighting.h"

#include "show/patch.h"

#include "core/config/config.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <memory>
#include <utility>

namespace fantascope::app {
namespace {

constexpr double kRelayRate = 20;  // Hz; a relay clicks in tens of milliseconds
constexpr const char* kUnanswered = "it has not answered yet";
constexpr const char* kNotSent = "they were never sent";

}  // namespace

Lighting::Lighting(const show::Site& site, const show::InputLog& inputs, Devices& devices, const Clock& clock,
                   const show::ShowClock& showClock, Recording* recording, FaultLog& faults, show::EventLog& events)
    : site_(site),
      devices_(devices),
      clock_(clock),
      showClock_(showClock),
      recording_(recording),
      faults_(faults),
      events_(events),
      replica_(inputs),
      banks_(site.relayBanks.size()),
      endLevels_(show::endLevels(site)),
      whyUnended_(site.universes.size(), kNotSent) {
    for (Bank& bank : banks_) bank.whyUnsafe = kUnanswered;
    for (const show::Universe& universe : site.universes) {
        shared_.emplace_back();
        if (universe.desk) shared_.back().emplace(Shared{show::DmxMerge(universe.desk->merge)});
    }
}

void Lighting::mergeWithDesk(Devices::Line& line, Shared& shared, Time now, std::span<std::uint8_t, kDmxSlots> slots) {
    if (endsAt_.load() != Time::max()) shared.merge.claimNothing();
    while (const auto frame = line.desk->receive())
        shared.merge.receive({frame->slots, frame->source, frame->priority, frame->arrived, frame->silence, frame->ended});
    shared.merge.mergeAt(now, slots, shared.asked, slots);
    const auto charges = shared.merge.inCharge();
    if (std::ranges::equal(charges, shared.inCharge, {}, &show::DmxMerge::Charge::sender)) return;
    shared.inCharge.clear();
    for (const show::DmxMerge::Charge& charge : charges) shared.inCharge.emplace_back(charge.sender);
    const show::event::SendersChanged change{line.universe, shared.inCharge};
    const std::string device = fmt::format("universe {}", line.universe);
    const bool isTaken = shared.inCharge.front() != "";
    if (isTaken)
        faults_.raise(now, device, FaultLog::Topic::Desk, show::sentenceOf(change));
    else
        faults_.clear(now, device, FaultLog::Topic::Desk, "");
    events_.append({showClock_.showTime(now), change});
}

void Lighting::tick(Time moment) {
    const Time showTime = showClock_.showTime(moment), endsAt = endsAt_.load();
    replica_.stateAt(showClock_.showTime(std::min(moment, endsAt)), state_);
    for (std::size_t i = 0; i < shared_.size(); ++i)
        if (shared_[i]) show::slotsOf(site_, state_, site_.universes[i].number, shared_[i]->asked);
    show::applyTrim(site_, state_.lamps, state_);
    const bool atEnd = moment >= endsAt && (hurried_ || moment - endsAt >= site_.endFade);
    if (moment >= endsAt) fadeToEnd(atEnd ? 1 : seconds(moment - endsAt) / seconds(site_.endFade));
    const auto sendTo = [&](std::size_t i) {
        Devices::Line& line = devices_.lines[i];
        std::array<std::uint8_t, kDmxSlots> slots;
        show::slotsOf(site_, state_, line.universe, slots);
        if (shared_[i]) mergeWithDesk(line, *shared_[i], clock_.now(), slots);
        // A lost line reports this in its status and comes back by itself. The newest levels are
        // sent at the next tick.
        const Result<void> sent = line.port->send(slots);
        if (sent && recording_ != nullptr) recording_->lighting(showTime, line.universe, slots);
        if (!atEnd) return;
        const std::lock_guard lock(linesMutex_);
        whyUnended_[i] = sent ? "" : sent.error().message();
    };
    // An exception of one line's driver stops neither the other lines nor the relays. The part's
    // guard reports it.
    std::exception_ptr failure;
    for (std::size_t i = 0; i < devices_.lines.size(); ++i) {
        try {
            sendTo(i);
        } catch (...) {
            failure = std::current_exception();
        }
    }
    lampsEnded_ = atEnd;
    const Time now = clock_.now();
    if (lastTick_) dmxInterval_.add(now - *lastTick_);
    lastTick_ = now;
    for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
        banks_[bank].wanted.writable() = show::coilsOf(site_, state_, bank);
        banks_[bank].wanted.publish();
    }
    if (failure) std::rethrow_exception(failure);
}

std::vector<Part> Lighting::relayParts() {
    std::vector<Part> parts;
    for (std::size_t bank = 0; bank < banks_.size(); ++bank)
        parts.push_back({"relays " + site_.relayBanks[bank].name, kRelayRate, showClock_.runStart(),
                         [this, bank](Time moment) { relayTick(bank, moment); }, Rank::Lighting});
    return parts;
}

void Lighting::relayTick(std::size_t number, Time moment) {
    Bank& bank = banks_[number];
    bank.wanted.update();
    const Time now = clock_.now();
    const bool ending = now >= endsAt_.load();
    const Coils wanted = ending ? show::safeCoils(site_, number) : bank.wanted.value();
    if (wanted.empty()) return;
    const bool beginsToEnd = ending && !std::exchange(bank.ending, ending);
    const int losses = devices_.relayBanks[number]->status().losses;
    if (std::exchange(bank.losses, losses) != losses && !bank.written.empty()) takeLoss(number, moment);
    if (beginsToEnd && bank.written == wanted) confirm(number);
    if (bank.written == wanted && bank.isFaulty && now - bank.confirmed >= kLatestRelays) reportRecovery(number, moment);
    const bool mayTry = ending || bank.tried != wanted || now >= bank.nextTry;
    if (bank.written != wanted && !mayTry) return;
    const Result<void> brought = bringTo(wanted, number, moment);
    if (!ending) return;
    const std::lock_guard lock(bank.mutex);
    bank.whyUnsafe = brought ? "" : brought.error().message();
}

void Lighting::confirm(std::size_t number) {
    Bank& bank = banks_[number];
    const auto now = devices_.relayBanks[number]->read();
    if (!now || *now != bank.written) bank.written.clear();
}

Result<void> Lighting::bringTo(const Coils& wanted, std::size_t number, Time moment) {
    Bank& bank = banks_[number];
    RelayBank& device = *devices_.relayBanks[number];
    if (wanted == bank.written) return {};
    bank.written.clear();
    const bool isThere = device.status().state == DeviceState::Running;
    const Result<void> written = device.write(wanted);
    bank.tried = wanted;
    if (!written) {
        // A missing bank is tried at every tick, so that it has its states as soon as it is back.
        // Such a try costs nothing.
        if (isThere) bank.nextTry = clock_.now() + bank.backOff.failed(clock_.now());
        if (!bank.ending && device.status().state == DeviceState::Running) reportRefusal(number, written.error(), moment);
        return written;
    }
    bank.written = wanted;
    bank.backOff.succeeded(clock_.now());
    bank.confirmed = clock_.now();
    if (recording_ != nullptr) recording_->relays(showClock_.showTime(moment), site_.relayBanks[number].name, bank.written);
    return {};
}

// After a loss the states of the relays are unknown. A bank that was gone may be in its safe
// states.
void Lighting::takeLoss(std::size_t number, Time moment) {
    Bank& bank = banks_[number];
    const std::string moved =
        bank.ending ? "" : differing(number, bank.written);  // at the end, the safe states do not wait for a read
    bank.written.clear();
    bank.nextTry = clock_.now() + bank.backOff.failed(clock_.now());
    if (moved.empty()) return;
    reportFault(number, moment,
                fmt::format("{} of '{}' switched without the show: by hand, by another program, or without power. The show "
                            "switches back",
                            moved, site_.relayBanks[number].name));
}

void Lighting::reportRefusal(std::size_t number, const Error& error, Time moment) {
    const std::string stuck = differing(number, banks_[number].tried);
    reportFault(number, moment,
                fmt::format("{} of '{}' did not switch ({}). The show tries again; look at the module",
                            stuck.empty() ? "relays" : stuck, site_.relayBanks[number].name, error.message()));
}

void Lighting::reportFault(std::size_t number, Time moment, const std::string& what) {
    banks_[number].isFaulty = true;
    faults_.raise(moment, site_.relayBanks[number].name, FaultLog::Topic::Relays, what);
}

void Lighting::reportRecovery(std::size_t number, Time moment) {
    banks_[number].isFaulty = false;
    const std::string& name = site_.relayBanks[number].name;
    faults_.clear(moment, name, FaultLog::Topic::Relays, "the relays of '" + name + "' are as they should be");
}

std::string Lighting::differing(std::size_t number, const Coils& wanted) {
    const auto states = devices_.relayBanks[number]->read();
    std::vector<std::string> names;
    for (const show::Relay& relay : site_.relays)
        if (const auto coil = static_cast<std::size_t>(relay.coil);
            states && relay.bank == number && (*states)[coil] != wanted[coil])
            names.push_back(relay.name);
    return listed(names);
}

void Lighting::fadeToEnd(double share) {
    for (std::size_t i = 0; i < endLevels_.size(); ++i)
        state_.levels[i] = std::lerp(state_.levels[i], endLevels_[i], static_cast<float>(share));
}

void Lighting::end(Time moment) {
    Time never = Time::max();
    endsAt_.compare_exchange_strong(never, moment);
}

bool Lighting::ended() const { return lampsEnded_ && unsafeBanks().empty(); }

std::vector<UnsafeBank> Lighting::unsafeBanks() const {
    std::vector<UnsafeBank> unsafe;
    for (std::size_t number = 0; number < banks_.size(); ++number) {
        const std::lock_guard lock(banks_[number].mutex);
        if (!banks_[number].whyUnsafe.empty()) unsafe.push_back({site_.relayBanks[number].name, banks_[number].whyUnsafe});
    }
    return unsafe;
}

std::vector<UnendedLine> Lighting::unendedLines() const {
    std::vector<UnendedLine> lines;
    const std::lock_guard lock(linesMutex_);
    for (std::size_t i = 0; i < whyUnended_.size(); ++i)
        if (!whyUnended_[i].empty()) lines.push_back({site_.universes[i].number, whyUnended_[i]});
    return lines;
}

}  // namespace fantascope::app
