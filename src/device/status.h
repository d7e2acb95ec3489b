#pragma once

#include <string>

namespace fantascope {

// Where a device is in its life:
//   Absent -> Starting -> Running    found, then opened, then it does its work
//   Running -> Faulted -> Starting   it misbehaves or went silent; it is tried again with back-off
//   any -> Absent                    unplugged, or never there
enum class DeviceState { Absent, Starting, Running, Faulted };

// What takes effect at the far end when the device is lost. Declared by each driver, shown with its
// status.
enum class LossAction {
    Hold,      // the last value stays (a DMX line into most dimmers)
    Dark,      // the picture or the light goes out (a projector without a signal)
    SafeState  // the state declared as safe in the site file (relays)
};

// What every device says of itself, for the console, the report and the log.
struct DeviceStatus {
    std::string name;    // as in the site file: "left", "universe 1"
    std::string driver;  // as in the registry: "headless", "simulated"
    DeviceState state = DeviceState::Absent;
    LossAction onLoss = LossAction::Hold;
    std::string detail;     // why not Running and what to do about it; empty when Running
    int losses = 0;         // times that it left Running since the start
    std::string trouble{};  // what it does not do although it is Running; empty: it does all
};

constexpr const char* nameOf(DeviceState state) {
    switch (state) {
        case DeviceState::Absent:
            return "absent";
        case DeviceState::Starting:
            return "starting";
        case DeviceState::Running:
            return "running";
        case DeviceState::Faulted:
            return "faulted";
    }
    return "unknown";
}

// What every port has in common.
//
// Life: a driver's open() gives a device that may be Absent: a missing device is no error of
// open(), a wrong key in its part of the site file is. A lost device comes back by itself, retried
// with back-off on its own time; the same object serves before and after.
// Errors: a call on a device that is not Running returns an error, does nothing, never waits, and
// leaves other devices alone.
// Thread: status() may be called from any thread at any time; every other method from the one
// thread that each port names.
class Device {
public:
    virtual ~Device() = default;
    virtual DeviceStatus status() const = 0;
};

}  // namespace fantascope
