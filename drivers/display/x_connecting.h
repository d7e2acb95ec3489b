#pragma once

#include <mutex>

namespace fantascope::drivers {

// A lock to hold while you connect to an X server, by XCB, Xlib or GLFW. libXau keeps the name of
// the authority file in one buffer for all threads, and a second thread would free it. Thread: any.
inline std::unique_lock<std::mutex> connectingToX() {
    static std::mutex mutex;
    return std::unique_lock(mutex);
}

}  // namespace fantascope::drivers
