#pragma once
// Modbus modules that we did not write: pymodbus, in a process of its own
// (tests/peers/modbus_peer.py has its commands).

#include "core/result.h"
#include "scratch_folder.h"

#include <sys/types.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace fantascope {

class ModbusPeer {
public:
    enum class Wire { Tcp, Rtu };
    // Why there can be none on this machine; "" where there can.
    static std::string missing();

    // With so many lines, each with two modules, units 1 and 2.
    ModbusPeer(Wire wire, int lines);
    ~ModbusPeer();
    ModbusPeer(const ModbusPeer&) = delete;
    ModbusPeer& operator=(const ModbusPeer&) = delete;

    // What a site file says to use a line, but for what is of relays or contacts alone. Stays as it
    // is over a restart.
    std::string options(int line) const;
    std::string ask(const std::string& command) const;

    void kill();     // as a module without power
    void restart();  // ... that comes up anew
    void stop();     // it hangs: its lines are there and nobody answers
    void resume();

    // What became of the coils, in order: by whom ("write", "struck") and all of them as they were
    // then, a character each.
    struct Change {
        int line;  // 100 more for unit 2
        std::string by, coils;
    };
    std::vector<Change> journal() const;

private:
    void start();

    const Wire wire_;
    ScratchFolder folder_;
    std::vector<std::string> places_;  // a line's port or link
    pid_t child_ = -1;
    int commands_ = -1, answers_ = -1;
};

}  // namespace fantascope
