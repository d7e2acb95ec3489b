#include "drivers/modbus/bus.h"

#include "drivers/common/shared.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fantascope::drivers {
namespace {

constexpr Time kLong = std::chrono::hours(1);  // until wake()

}  // namespace

Result<std::shared_ptr<ModbusBus>> ModbusBus::of(const ConfigNode& node, const ModbusLineOptions& options, const Clock& clock) {
    static Shared<std::pair<const Clock*, std::string>, ModbusBus> buses;
    auto bus = buses.get({&clock, nameOf(options)}, [&] { return std::make_shared<ModbusBus>(options, clock); });
    if (bus->options_ == options) return bus;
    return node.error(
        fmt::format("another device uses {} with other settings; all devices on a line need the same settings", nameOf(options)));
}

ModbusBus::ModbusBus(const ModbusLineOptions& options, const Clock& clock)
    : options_(options),
      clock_(clock),
      line_(options, clock),
      service_(nameOf(options), "modbus", LossAction::Hold, [this](Service& service) { return runOnce(service); }) {}

Outage ModbusBus::runOnce(Service& service) {
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
        active_ = unit;
        lock.unlock();
        const ModbusUnit::TurnResult result = unit->execute(line_, call);
        lock.lock();
        unit->finish(result, call);
        const ModbusFailure* const failure = std::get_if<ModbusFailure>(&result);
        const bool lineIsGone = failure != nullptr && failure->wholeLine;
        if (lineIsGone) loseAll(failure->outage);
        active_ = nullptr;
        turnEnded_.notify_all();
        if (lineIsGone) return failure->outage;
        lock.unlock();
        if (failure == nullptr)
            service.setRunning();  // only now, so that a peer that accepts and hangs up at once is retried ever more rarely
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
    : bus_(std::move(bus)), turn_(std::move(turn)), status_{std::move(name), std::move(driver), DeviceState::Starting,
                                                            onLoss,          "looking for it",  0} {
    const std::lock_guard lock(bus_->mutex_);
    bus_->units_.push_back(this);
    bus_->service_.wake();
}

ModbusUnit::~ModbusUnit() {
    std::unique_lock lock(bus_->mutex_);
    bus_->turnEnded_.wait(lock, [&] { return bus_->active_ != this; });
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
    bus_->service_.wake();
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

ModbusUnit::TurnResult ModbusUnit::execute(ModbusLine& line, Call* call) {
    if (call == nullptr) return turn_(line);
    if (auto failure = call->job(line)) return *std::move(failure);
    return Time{};
}

void ModbusUnit::finish(const TurnResult& result, Call* call) {
    const Time now = bus_->clock_.now();
    const auto* const failure = std::get_if<ModbusFailure>(&result);
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
        due_ = now;  // the job may have changed what is due next
        return;
    }
    const auto* back = std::get_if<Returned>(&result);
    due_ = back != nullptr ? back->next : std::get<Time>(result);
    if (back != nullptr) ++status_.losses;
    if (status_.state == DeviceState::Running) return;
    status_.state = DeviceState::Running;
    status_.detail.clear();
    backOff_.succeeded(now);
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
