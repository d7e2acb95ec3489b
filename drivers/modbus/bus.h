#pragma once

#include "drivers/common/back_off.h"
#include "drivers/common/service.h"
#include "drivers/modbus/line.h"
#include "drivers/modbus/values.h"

#include "device/status.h"

#include "core/clock.h"
#include "core/config.h"
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

// A line with its one thread, on which all units on it take turns: who is due first goes first. A
// unit that does not answer is tried ever more rarely (BackOff); a line that is gone is tried again
// by its Service, and all its units are lost until then.
class ModbusBus {
public:
    // The bus of that line, for as long as anybody holds it. Error: somebody has it already with
    // other settings (rate, time-out).
    static Result<std::shared_ptr<ModbusBus>> of(const ConfigNode& node, const ModbusLineOptions& options, const Clock& clock);
    ModbusBus(const ModbusLineOptions& options, const Clock& clock);

    const Clock& clock() const { return clock_; }

private:
    friend class ModbusUnit;
    Outage attend(Service& service);
    // The unit whose turn it is, and nothing when all may wait until `due`.
    ModbusUnit* nextUnit(Time& due) const;
    void loseAll(const Outage& outage);

    const ModbusLineOptions options_;
    const Clock& clock_;
    ModbusLine line_;  // of the thread alone
    std::mutex mutex_;
    std::condition_variable turnEnded_;
    std::vector<ModbusUnit*> units_;
    const ModbusUnit* atTurn_ = nullptr;
    Service service_;
};

// One device on a bus: what it does at its turns, and what it says of itself. It is the device's
// last member, so that no turn is under way when anything that it uses goes.
class ModbusUnit {
public:
    // The unit was away without anybody's noticing, and is back.
    struct CameBack {
        Time next;
    };
    // When the next turn is due, or why this one failed: then the unit is lost. One that came back
    // was lost in between.
    using Turned = std::variant<Time, CameBack, ModbusFailure>;
    // On the bus's thread. Until one has succeeded the unit is not Running; of that turn everything
    // must end by responseTimeout.
    using Turn = std::function<Turned(ModbusLine&)>;
    using Job = std::function<ModbusOutcome(ModbusLine&)>;

    ModbusUnit(std::shared_ptr<ModbusBus> bus, std::string name, std::string driver, LossAction onLoss, Turn turn);
    ~ModbusUnit();
    ModbusUnit(const ModbusUnit&) = delete;
    ModbusUnit& operator=(const ModbusUnit&) = delete;

    // From any thread; never wait for the line.
    DeviceStatus status() const;
    const std::string& name() const { return status_.name; }  // constant
    bool isRunning() const { return status().state == DeviceState::Running; }

    // Does a job on the bus's thread at once, but for the requests that are under way or due
    // before, and waits for it. The job's own requests must end by `deadline`; what has not begun
    // by then never begins. Error: not Running, no time, or the job failed: then the unit is lost,
    // unless it answered that it will not.
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
    Turned take(ModbusLine& line, Call* call);
    void settle(const Turned& turned, Call* call);
    void lose(const Outage& outage);
    Error refusal() const;  // with the mutex held

    const std::shared_ptr<ModbusBus> bus_;
    const Turn turn_;
    // By bus_->mutex_:
    DeviceStatus status_;
    BackOff backOff_;
    Time due_{};
    Call* call_ = nullptr;
};

}  // namespace fantascope::drivers
