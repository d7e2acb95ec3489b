#pragma once

#include "app/live/run_report.h"

#include "show/event.h"
#include "show/show_clock.h"

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

// What fails while a show runs: each fault is an event, once, and kept for the report. A device has
// one fault of a topic at a time. It is told the machine's moments, since a device is missing as
// long while the show stands still; events and report have show time. Thread: any.
class FaultLog {
public:
    enum class Topic { Missing, Trouble, Relays, Desk, SafeStates, EndLevels, Guard, Recording, RecordedFrames, Part };

    // After kBurst faults of a topic within kRestless the next one is told as coming and going, and
    // nothing more until it was steady for so long.
    static constexpr int kBurst = 10;
    static constexpr Time kRestless = std::chrono::seconds(5);

    // `events` outlives it.
    explicit FaultLog(show::EventLog& events) : events_(events) {}
    // By which moments are show times. Before the first fault.
    void begin(const show::ShowClock& showClock) { showClock_ = showClock; }

    // What is wrong at `moment`. The same again changes nothing; something else takes its place.
    void raise(Time moment, const std::string& device, Topic topic, const std::string& what);
    // Nothing is wrong at `moment`. If something was, `news` is told with how long that lasted;
    // empty: nothing is told.
    void clear(Time moment, const std::string& device, Topic topic, const std::string& news);

    std::vector<FaultReport> faults() const;  // by their beginning

private:
    struct TopicState {
        std::optional<std::size_t> open;  // index into faults_
        std::vector<std::size_t> recent;  // the newest kBurst at most
        bool restless = false;
        Time raised{};  // last
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

// Looks at all devices again and again, and reports each that is missing at the start, goes, or
// comes back.
// Thread: thread-bound.
class DeviceWatch {
public:
    // `faults` outlives this. A relay bank that is there counts switching by others as a loss;
    // Lighting reports that.
    DeviceWatch(FaultLog& faults, std::vector<std::string> relayBanks, Time runStart)
        : faults_(faults), relayBanks_(std::move(relayBanks)), runStart_(runStart) {}

    static constexpr double kRate = 10;                          // Hz
    static constexpr Time kPatience = std::chrono::seconds(10);  // with devices that are being looked for at the start
    void look(Time moment, std::span<const DeviceStatus> devices);

private:
    FaultLog& faults_;
    const std::vector<std::string> relayBanks_;
    const Time runStart_;
    std::map<std::string, int> losses_;  // of each device, as it was seen last
};

}  // namespace fantascope::app
