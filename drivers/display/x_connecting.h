#pragma once

#include <mutex>

namespace fantascope::drivers {

// Whoever connects to an X server holds this meanwhile, with XCB, Xlib or GLFW: libXau keeps the
// name of the authority file in a buffer that all threads share, and may free it under another
// thread's hands. Thread: any.
inline std::unique_lock<std::mutex> connectingToX() {
    static std::mutex mutex;
    return std::unique_lock(mutex);
}

}  // namespace fantascope::drivers
