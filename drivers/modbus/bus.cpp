#include "drivers/modbus/bus.h"

#include "drivers/common/shared.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fantascope::drivers {
namespace {

constexpr Time kLong = std::chrono::hours(1);  // until somebody calls

}  // namespace

Result<std::shared_ptr<ModbusBus>> ModbusBus::of(const ConfigNode& node, const ModbusLineOptions& options, const Clock& clock) {
    static Shared<std::pair<const Clock*, std::string>, ModbusBus> buses;
    auto bus = buses.get({&clock, nameOf(options)}, [&] { return std::make_shared<ModbusBus>(options, clock); });
    if (bus->options_ == options) return bus;
    return node.error(fmt::format("another device has {} with other settings; all on one line need the same", nameOf(options)));
}

ModbusBus::ModbusBus(const ModbusLineOptions& options, const Clock& clock)
    : options_(options),
      clock_(clock),
      line_(options, clock),
      service_(nameOf(options), "modbus", LossAction::Hold, [this](Service& service) { return attend(service); }) {}

Outage ModbusBus::attend(Service& service) {
    if (auto failure = line_.open(clock_.now() + options_.responseTimeout)) {
        const std::lock_guard lock(mutex_);
        loseAll(failure->outage);
        return failure->outage;
    }
    for (std::unique_lock lock(mutex_); !service.ending(); lock.lock()) {
        Time due = clock_.now() + kLong;
        ModbusUnit* const unit = nextUnit(due);
        if (unit == nullptr) {
            lock.unlock();
            service.wait(due - clock_.now());
            continue;
        }
        ModbusUnit::Call* const call = unit->call_;
        if (call != nullptr) call->begun = true;
        atTurn_ = unit;
        lock.unlock();
        const ModbusUnit::Turned turned = unit->take(line_, call);
        lock.lock();
        unit->settle(turned, call);
        const ModbusFailure* const failure = std::get_if<ModbusFailure>(&turned);
        const bool lineIsGone = failure != nullptr && failure->ofLine;
        if (lineIsGone) loseAll(failure->outage);
        atTurn_ = nullptr;
        turnEnded_.notify_all();
        if (lineIsGone) return failure->outage;
        lock.unlock();
        if (failure == nullptr)
            service.running();  // not sooner: who connects and hangs up at once is to be tried ever more rarely
    }
    return {};
}

ModbusUnit* ModbusBus::nextUnit(Time& due) const {
    const auto first = std::min_element(units_.begin(), units_.end(),
                                        [](const ModbusUnit* a, const ModbusUnit* b) { return a->due() < b->due(); });
    if (first == units_.end()) return nullptr;
    due = std::min(due, (*first)->due());
    return due <= clock_.now() ? *first : nullptr;
}

void ModbusBus::loseAll(const Outage& outage) {
    for (ModbusUnit* unit : units_) {
        unit->lose(outage);
        unit->due_ = clock_.now();  // as soon as the line is back
    }
    turnEnded_.notify_all();
}

ModbusUnit::ModbusUnit(std::shared_ptr<ModbusBus> bus, std::string name, std::string driver, LossAction onLoss, Turn turn)
    : bus_(std::move(bus)), turn_(std::move(turn)), status_{std::move(name), std::move(driver),        DeviceState::Starting,
                                                            onLoss,          "it is being looked for", 0} {
    const std::lock_guard lock(bus_->mutex_);
    bus_->units_.push_back(this);
    bus_->service_.call();
}

ModbusUnit::~ModbusUnit() {
    std::unique_lock lock(bus_->mutex_);
    bus_->turnEnded_.wait(lock, [&] { return bus_->atTurn_ != this; });
    std::erase(bus_->units_, this);
}

DeviceStatus ModbusUnit::status() const {
    const std::lock_guard lock(bus_->mutex_);
    return status_;
}

Error ModbusUnit::refusal() const {
    return Error(
        fmt::format("{} is {}{}{}", status_.name, nameOf(status_.state), status_.detail.empty() ? "" : ": ", status_.detail));
}

Result<void> ModbusUnit::run(const Job& job, Time deadline) {
    std::unique_lock lock(bus_->mutex_);
    if (status_.state != DeviceState::Running) return refusal();
    Call call{job, bus_->clock_.now(), false, {}};
    call_ = &call;
    bus_->service_.call();
    while (!call.answer) {
        if (call.begun) {
            bus_->turnEnded_.wait(lock);  // its requests end by the deadline
            continue;
        }
        const Time left = deadline - bus_->clock_.now();
        if (left <= Time::zero()) {
            call_ = nullptr;
            return Error(fmt::format("{}: {} was busy with other requests", status_.name, nameOf(bus_->options_)));
        }
        bus_->turnEnded_.wait_for(lock, left);
    }
    return *call.answer;
}

ModbusUnit::Turned ModbusUnit::take(ModbusLine& line, Call* call) {
    if (call == nullptr) return turn_(line);
    if (auto failure = call->job(line)) return *std::move(failure);
    return Time{};
}

void ModbusUnit::settle(const Turned& turned, Call* call) {
    const Time now = bus_->clock_.now();
    const auto* const failure = std::get_if<ModbusFailure>(&turned);
    if (failure != nullptr && failure->isRefusal && call != nullptr) {
        call->answer = Result<void>(Error(fmt::format("{}: {}", status_.name, failure->outage.why)));
        call_ = nullptr;
        due_ = now;
        return;
    }
    if (failure != nullptr) {
        lose(failure->outage);
        due_ = now + backOff_.failed(now);
        return;
    }
    if (call != nullptr) {
        call->answer = Result<void>();
        call_ = nullptr;
        due_ = now;  // what is due next may be another thing now
        return;
    }
    const auto* back = std::get_if<CameBack>(&turned);
    due_ = back != nullptr ? back->next : std::get<Time>(turned);
    if (back != nullptr) ++status_.losses;
    if (status_.state == DeviceState::Running) return;
    status_.state = DeviceState::Running;
    status_.detail.clear();
    backOff_.began(now);
}

void ModbusUnit::lose(const Outage& outage) {
    if (status_.state == DeviceState::Running) ++status_.losses;
    status_.state = outage.state;
    status_.detail = outage.why;
    if (call_ == nullptr) return;
    call_->answer = Result<void>(refusal());
    call_ = nullptr;
}

}  // namespace fantascope::drivers
