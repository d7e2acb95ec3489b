#pragma once

namespace fantascope::app {

// While one lives, the first Ctrl-C (SIGINT) and the first SIGTERM only raise a flag, so that the best so far is kept and lamps
// come back; the second of the same kind ends the program at once. At most one lives at a time. Thread: requested() is
// thread-safe.
class Interrupt {
public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    bool requested() const;
};

}  // namespace fantascope::app
