#include "app/lighting.h"

#include "show/patch.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

namespace fantascope::app {
namespace {

constexpr double kRelayRate = 20;  // Hz; a relay clicks in tens of milliseconds

}  // namespace

Lighting::Lighting(const show::Site& site, const show::CueList& cues, Devices& devices, const Clock& clock, Time start,
                   Recording* recording)
    : site_(site), devices_(devices), clock_(clock), start_(start), recording_(recording), replica_(cues) {
    for (std::size_t bank = 0; bank < site.relayBanks.size(); ++bank) banks_.emplace_back(show::safeCoils(site, bank));
    for (const show::Universe& universe : site.universes) {
        shared_.emplace_back();
        if (universe.desk) shared_.back().emplace(Shared{show::DmxMerge(universe.desk->merge)});
    }
}

void Lighting::mergeWithDesk(Devices::Line& line, Shared& shared, Time now, std::span<std::uint8_t, kDmxSlots> slots) {
    while (const auto frame = line.desk->receive())
        shared.merge.receive({frame->slots, frame->source, frame->priority, frame->arrived, frame->silence, frame->ended});
    shared.merge.mergeAt(now, slots, slots);
    const auto charges = shared.merge.inCharge();
    if (std::ranges::equal(charges, shared.inCharge, {}, &show::DmxMerge::Charge::sender)) return;
    shared.inCharge.clear();
    for (const show::DmxMerge::Charge& charge : charges) shared.inCharge.emplace_back(charge.sender);
    std::vector<std::string> names;
    for (const std::string& sender : shared.inCharge) names.push_back(sender.empty() ? "the show" : "'" + sender + "'");
    tell(fmt::format("universe {} is now sent by {}", line.universe, fmt::join(names, " and ")));
}

void Lighting::tick(Time moment) {
    const Time showTime = moment - start_;
    replica_.stateAt(showTime, state_);
    for (std::size_t i = 0; i < devices_.lines.size(); ++i) {
        Devices::Line& line = devices_.lines[i];
        std::array<std::uint8_t, kDmxSlots> slots;
        show::slotsOf(site_, state_, line.universe, slots);
        if (shared_[i]) mergeWithDesk(line, *shared_[i], clock_.now(), slots);
        // A line that is not there says so in its status and comes back by itself; the newest levels go out at the next tick.
        if (line.port->send(slots) && recording_ != nullptr) recording_->lighting(showTime, line.universe, slots);
    }
    const Time now = clock_.now();
    if (lastTick_) dmxInterval_.add(now - *lastTick_);
    lastTick_ = now;
    for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
        banks_[bank].wanted.writable() = show::coilsOf(site_, state_, bank);
        banks_[bank].wanted.publish();
    }
}

std::vector<Part> Lighting::relayParts() {
    std::vector<Part> parts;
    for (std::size_t bank = 0; bank < banks_.size(); ++bank)
        parts.push_back({"relays " + site_.relayBanks[bank].name, kRelayRate, start_,
                         [this, bank](Time moment) { relayTick(bank, moment); }, Rank::Lighting});
    return parts;
}

void Lighting::relayTick(std::size_t number, Time moment) {
    Bank& bank = banks_[number];
    RelayBank& device = *devices_.relayBanks[number];
    bank.wanted.update();
    const int losses = device.status().losses;
    if (losses != bank.losses)
        bank.written.clear();  // who knows what they are now: where the bank was gone, in their safe states
    bank.losses = losses;
    if (bank.wanted.value() == bank.written) return;
    if (!device.write(bank.wanted.value())) {
        bank.written.clear();
        return;
    }
    bank.written = bank.wanted.value();
    if (recording_ != nullptr) recording_->relays(moment - start_, site_.relayBanks[number].name, bank.written);
}

}  // namespace fantascope::app
