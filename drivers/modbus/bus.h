#pragma once

#include "drivers/common/back_off.h"
#include "drivers/common/service.h"
#include "drivers/modbus/line.h"
#include "drivers/modbus/values.h"

#include "device/status.h"

#include "core/clock.h"
#include "core/config/config.h"
#include "core/result.h"

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace fantascope::drivers {

class ModbusUnit;

// A line and its one thread. All units on the line take turns; the one that is due first goes
// first. A unit that does not answer is retried ever more rarely (BackOff). A lost line is retried
// by its Service, and all its units are lost until it is back.
class ModbusBus {
public:
    // The bus of a line, shared while somebody holds it. Error: it is in use with other settings
    // (rate, timeout).
    static Result<std::shared_ptr<ModbusBus>> of(const ConfigNode& node, const ModbusLineOptions& options, const Clock& clock);
    ModbusBus(const ModbusLineOptions& options, const Clock& clock);

    const Clock& clock() const { return clock_; }

private:
    friend class ModbusUnit;
    Outage runOnce(Service& service);
    // The unit whose turn it is; nothing if none is due before `due`.
    ModbusUnit* nextUnit(Time& due) const;
    void loseAll(const Outage& outage);

    const ModbusLineOptions options_;
    const Clock& clock_;
    ModbusLine line_;  // used only by the thread
    std::mutex mutex_;
    std::condition_variable turnEnded_;
    std::vector<ModbusUnit*> units_;
    const ModbusUnit* active_ = nullptr;
    Service service_;
};

// One device on a bus: its work at each turn, and its status. It is the device's last member, so no
// turn is under way when anything that a turn uses is destroyed.
class ModbusUnit {
public:
    // The unit was away unnoticed, and is back. This counts as a loss.
    struct Returned {
        Time next;
    };
    // When the next turn is due, or why this one failed. A failure means that the unit is lost.
    using TurnResult = std::variant<Time, Returned, ModbusFailure>;
    // Called on the bus's thread. The unit is Running after the first success. Until then, a turn
    // must end within responseTimeout.
    using Turn = std::function<TurnResult(ModbusLine&)>;
    using Job = std::function<ModbusOutcome(ModbusLine&)>;

    ModbusUnit(std::shared_ptr<ModbusBus> bus, std::string name, std::string driver, LossAction onLoss, Turn turn);
    ~ModbusUnit();
    ModbusUnit(const ModbusUnit&) = delete;
    ModbusUnit& operator=(const ModbusUnit&) = delete;

    // From any thread. These never wait for the line.
    DeviceStatus status() const;
    const std::string& name() const { return status_.name; }  // constant
    bool isRunning() const { return status().state == DeviceState::Running; }

    // Runs a job on the bus's thread as soon as possible, and waits for it; requests that are under
    // way or due earlier go first. The job's own requests must end by `deadline`; a job that has
    // not begun by then is dropped. Error: not Running, no time left, or the job failed. A failure
    // means that the unit is lost, unless the unit itself refused.
    Result<void> run(const Job& job, Time deadline);

private:
    friend class ModbusBus;
    struct Call {
        const Job& job;
        Time since;
        bool begun = false;
        std::optional<Result<void>> answer;
    };
    Time due() const { return call_ != nullptr ? std::min(call_->since, due_) : due_; }
    TurnResult execute(ModbusLine& line, Call* call);
    void finish(const TurnResult& result, Call* call);
    void lose(const Outage& outage);
    Error refusal() const;  // with the mutex held

    const std::shared_ptr<ModbusBus> bus_;
    const Turn turn_;
    // Guarded by bus_->mutex_:
    DeviceStatus status_;
    BackOff backOff_;
    Time due_{};
    Call* call_ = nullptr;
};

}  // namespace fantascope::drivers
