#pragma once
// Modbus modules by other authors: pymodbus, in a process of its own (tests/peers/modbus_peer.py
// lists its commands).

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
    // Why this machine cannot run it; "" if it can.
    static std::string missing();

    // With this many lines, each with two modules, units 1 and 2.
    ModbusPeer(Wire wire, int lines);
    ~ModbusPeer();
    ModbusPeer(const ModbusPeer&) = delete;
    ModbusPeer& operator=(const ModbusPeer&) = delete;

    // The site file's keys for a line, except those for relays or contacts. Stays the same over a
    // restart.
    std::string options(int line) const;
    std::string ask(const std::string& command) const;

    void kill();     // like a module without power
    void restart();  // ... that starts again
    void stop();     // it hangs: its lines exist and nobody answers
    void resume();

    // The changes of the coils, in order: the cause ("write", "struck") and all coils afterwards,
    // one character each.
    struct Change {
        int line;  // plus 100 for unit 2
        std::string by, coils;
    };
    std::vector<Change> journal() const;

private:
    void start();

    const Wire wire_;
    ScratchFolder folder_;
    std::vector<std::string> places_;  // each line's port or link
    pid_t child_ = -1;
    int commands_ = -1, answers_ = -1;
};

}  // namespace fantascope
