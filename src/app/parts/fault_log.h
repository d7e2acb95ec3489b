#pragma once

#include "show/play/event.h"
#include "show/play/show_clock.h"

#include "device/status.h"

#include "core/clock.h"

#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {

struct FaultReport {
    Time at{};
    std::string what;
    std::string device{};         // by its name in the site file; empty: none
    std::optional<Time> until{};  // none: it lasted to the end, or it was only a moment
};

// The faults of a run. Each fault becomes an event once, and is kept for the report. A device has
// at most one fault of a topic at a time. Calls give moments on the machine's clock, because a
// fault lasts just as long while the show is paused. Events and report have show time. Thread: any.
class FaultLog {
public:
    enum class Topic { Missing, Trouble, Relays, Desk, SafeStates, EndLevels, Guard, Recording, RecordedFrames, Journal, Part };

    // After kBurst faults of a topic within kRestless, the next one is reported as coming and
    // going. Nothing more is reported until the topic has been steady for kRestless.
    static constexpr int kBurst = 10;
    static constexpr Time kRestless = std::chrono::seconds(5);

    // `events` outlives the log.
    explicit FaultLog(show::EventLog& events) : events_(events) {}
    // Sets the clock that converts moments to show time. Call it before the first fault.
    void begin(const show::ShowClock& showClock) { showClock_ = showClock; }

    // Reports what is wrong at `moment`. The same text again changes nothing; another text ends the
    // present fault and begins another.
    void raise(Time moment, const std::string& device, Topic topic, const std::string& what);
    // Reports that nothing is wrong at `moment`. If there was a fault, the operator is told `news`
    // and how long the fault lasted. With empty `news` the operator is not told.
    void clear(Time moment, const std::string& device, Topic topic, const std::string& news);

    // raise(), or clear() if `what` is empty.
    void tell(Time moment, const std::string& device, Topic topic, const std::string& what, const std::string& news) {
        what.empty() ? clear(moment, device, topic, news) : raise(moment, device, topic, what);
    }

    std::vector<FaultReport> faults() const;  // in the order of their beginning
    std::vector<FaultReport> open() const;    // those that last, by device

private:
    struct TopicState {
        std::optional<std::size_t> open;  // index into faults_
        std::vector<std::size_t> recent;  // at most the newest kBurst
        bool restless = false;
        Time raised{};  // the last time
    };
    struct Fault {
        Time moment{};
        std::string what, device;
        std::optional<Time> until{};
    };
    void add(TopicState& state, Time moment, const std::string& device, const std::string& what);

    show::EventLog& events_;
    show::ShowClock showClock_;
    mutable std::mutex mutex_;
    std::map<std::pair<std::string, Topic>, TopicState> topics_;
    std::vector<Fault> faults_;
};

// Polls the status of all devices. Reports each device that is missing at the start, is lost, or
// comes back.
// Thread: thread-bound.
class DeviceWatch {
public:
    // `faults` outlives this. A running relay bank counts it as a loss when something else switches
    // its relays; Lighting reports that.
    DeviceWatch(FaultLog& faults, std::vector<std::string> relayBanks, Time runStart)
        : faults_(faults), relayBanks_(std::move(relayBanks)), runStart_(runStart) {}

    static constexpr double kRate = 10;                          // Hz
    static constexpr Time kPatience = std::chrono::seconds(10);  // how long a device may take to start
    void look(Time moment, std::span<const DeviceStatus> devices);

private:
    FaultLog& faults_;
    const std::vector<std::string> relayBanks_;
    const Time runStart_;
    std::map<std::string, int> losses_;  // of each device, at the last poll
};

}  // namespace fantascope::app
