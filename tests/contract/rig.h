#pragma once
// The base of all rigs, and the clauses for every device (device/status.h).

#include "device/status.h"

#include "contract/contract.h"
#include "core/clock.h"

#include <fmt/format.h>

#include <functional>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

// In a clause: if the condition fails, the clause is violated; the other arguments say what was
// seen.
#define CONTRACT_REQUIRE(condition, ...)                   \
    do {                                                   \
        if (!(condition)) return fmt::format(__VA_ARGS__); \
    } while (false)
// In a clause: if the result is an error, the clause is violated by it.
#define CONTRACT_SUCCEEDS(expression)                                                                          \
    do {                                                                                                       \
        if (const auto done_ = (expression); !done_) return #expression " failed: " + done_.error().message(); \
    } while (false)

namespace fantascope::contract {

// A port under test with its far end.
template <class Port>
class Rig {
public:
    using PortType = Port;
    virtual ~Rig() = default;

    virtual Port& port() = 0;
    // Closes the port and opens it again on whatever is there now.
    virtual void reopen() = 0;
    virtual void unplug() = 0;
    virtual void plugIn() = 0;
    // Lets the time pass that the port and its line need to notice what happened and to carry what
    // is on its way.
    virtual void letTimePass() = 0;
    // The clock that open() was handed.
    virtual Clock& clock() = 0;
    // Another device on the same machine.
    virtual Device& neighbour() = 0;

    void lose() {
        unplug();
        letTimePass();
    }
    void giveBack() {
        plugIn();
        letTimePass();
    }
};

// "" if the device reports correctly whether it runs, and why not.
inline std::string misreports(const Device& device, bool running) {
    const DeviceStatus status = device.status();
    CONTRACT_REQUIRE((status.state == DeviceState::Running) == running, "its state is {}", nameOf(status.state));
    CONTRACT_REQUIRE(status.detail.empty() == running, "it is {} and says '{}'", nameOf(status.state), status.detail);
    return "";
}

// `serves` uses the port for its purpose and returns what went wrong; it must be repeatable.
template <class AnyRig>
Suite<AnyRig> lifeClauses(const std::function<std::string(AnyRig&)>& serves) {
    return {
        {"a device that is there runs, with a name and a driver",
         [](AnyRig& rig) -> std::string {
             const DeviceStatus status = rig.port().status();
             CONTRACT_REQUIRE(!status.name.empty() && !status.driver.empty(), "name '{}', driver '{}'", status.name,
                              status.driver);
             return misreports(rig.port(), true);
         }},
        {"a lost device is not Running and says why",
         [](AnyRig& rig) -> std::string {
             rig.lose();
             return misreports(rig.port(), false);
         }},
        {"every loss is counted once",
         [](AnyRig& rig) -> std::string {
             for (int losses = 0; losses < 3; ++losses) {
                 CONTRACT_REQUIRE(rig.port().status().losses == losses, "{} after {}", rig.port().status().losses, losses);
                 rig.lose();
                 rig.giveBack();
             }
             return "";
         }},
        {"a lost device comes back by itself and the same object serves",
         [serves](AnyRig& rig) -> std::string {
             for (int time = 0; time < 2; ++time) {
                 rig.lose();
                 rig.giveBack();
                 if (auto wrong = misreports(rig.port(), true); !wrong.empty()) return wrong;
                 if (auto wrong = serves(rig); !wrong.empty()) return wrong;
             }
             return "";
         }},
        {"a device that is missing at the start opens all the same and serves once it is there",
         [serves](AnyRig& rig) -> std::string {
             rig.unplug();
             rig.reopen();
             rig.letTimePass();
             if (auto wrong = misreports(rig.port(), false); !wrong.empty()) return wrong;
             rig.giveBack();
             if (auto wrong = misreports(rig.port(), true); !wrong.empty()) return wrong;
             CONTRACT_REQUIRE(rig.port().status().losses == 0, "its absence counts as a loss");
             return serves(rig);
         }},
        {"a lost device leaves its neighbour alone",
         [serves](AnyRig& rig) -> std::string {
             rig.lose();
             (void)serves(rig);  // it cannot work, but it must not disturb the neighbour
             rig.giveBack();
             CONTRACT_REQUIRE(rig.neighbour().status().losses == 0, "the neighbour was lost too");
             return misreports(rig.neighbour(), true);
         }},
        {"status may be asked from any thread while the device serves",
         [serves](AnyRig& rig) -> std::string {
             // Data races are for the thread sanitizer; here the answers must be right.
             std::string wrong;
             std::jthread console([&] {
                 for (int asked = 0; asked < 100 && wrong.empty(); ++asked) wrong = misreports(rig.port(), true);
             });
             const std::string failed = serves(rig);
             console.join();
             return failed.empty() ? wrong : failed;
         }},
    };
}

// Everything that a poll() or a receive() returns. A port that never ends is stopped at an absurd
// number.
template <class Next>
auto drained(Next next) {
    std::vector<typename std::invoke_result_t<Next>::value_type> all;
    while (auto one = next()) {
        all.push_back(*one);
        if (all.size() > 10'000) break;
    }
    return all;
}

// One suite of several parts.
template <class AnyRig>
Suite<AnyRig> joined(Suite<AnyRig> first, const Suite<AnyRig>& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}

}  // namespace fantascope::contract
