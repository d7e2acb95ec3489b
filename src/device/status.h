#pragma once

#include <string>

namespace fantascope {

// The states of a device:
//   Absent -> Starting -> Running    found, then opened, then working
//   Running -> Faulted -> Starting   misbehaves or is silent; retried with back-off
//   any -> Absent                    unplugged, or never there
enum class DeviceState { Absent, Starting, Running, Faulted };

// What happens at the far end when the device is lost. Declared by each driver, shown with its
// status.
enum class LossAction {
    Hold,      // the last value stays (a DMX line into most dimmers)
    Dark,      // the picture or the light goes out (a projector without a signal)
    SafeState  // the state declared as safe in the site file (relays)
};

// The status of a device, for the console, the report and the log.
struct DeviceStatus {
    std::string name;    // as in the site file: "left", "universe 1"
    std::string driver;  // as in the registry: "headless", "simulated"
    DeviceState state = DeviceState::Absent;
    LossAction onLoss = LossAction::Hold;
    std::string detail;     // why it is not Running and what to do about it; empty: Running
    int losses = 0;         // how often it left Running since the start
    std::string trouble{};  // what fails although it is Running; empty: nothing
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

// The base of all ports.
//
// Life: open() returns a device that may be Absent. A missing device is no error; a wrong key in
// the site file is. A lost device comes back by itself, retried with back-off; the object stays the
// same.
// Errors: a call on a device that is not Running returns an error at once, does nothing, and
// affects no other device.
// Thread: status() may be called from any thread at any time; every other method only from the
// thread that its port names.
class Device {
public:
    virtual ~Device() = default;
    virtual DeviceStatus status() const = 0;
};

}  // namespace fantascope
