#pragma once

#include "core/check.h"
#include "core/clock.h"

#include <chrono>

namespace fantascope::contract {

// Returns once the condition holds. For things that real threads and a real kernel have on their
// way. A test that waits in vain fails, after far longer than a loaded machine needs.
template <class Condition>
void eventually(const char* what, Condition condition) {
    SteadyClock clock;
    while (!condition()) {
        FANTASCOPE_CHECK(clock.now() < std::chrono::minutes(2), what);
        clock.sleepUntil(clock.now() + std::chrono::milliseconds(1));
    }
}

}  // namespace fantascope::contract
