#pragma once
// Faults, one after another, on a bank of relays in use: what the peer saw of it.

#include "core/clock.h"
#include "peers/modbus_peer.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace fantascope {

struct ModbusCampaign {
    static constexpr Time kSoon = std::chrono::seconds(2);  // within which the wanted states must be restored after a fault

    std::map<std::string, std::vector<double>>
        recovery;                    // seconds from the end of a fault to the wanted states, by kind of fault
    std::vector<std::string> slow;   // what was not restored soon, step by step
    std::vector<std::string> wrong;  // what must never happen, in words
    std::size_t writes = 0;          // writes that the modules saw
    std::size_t stalls = 0;          // stalls of a module's process, which repeated a fault that was over
};

// Like the program (src/app/live/lighting.cpp): the wanted states are written when they change,
// after every loss, and again after a failed write. A module process that gets no processor time
// for half a response timeout is as good as stopped: such a fault is not over before the process
// runs again.
ModbusCampaign runModbusCampaign(ModbusPeer::Wire wire, int faults, std::uint64_t seed);

}  // namespace fantascope
