#pragma once

#include "core/result.h"

#include <memory>
#include <string>

namespace fantascope::drivers {

// The process's use of GLFW, for as long as a window needs it. Thread: the main thread.
class GlfwLibrary {
public:
    // Error: there is no X server.
    static Result<std::shared_ptr<GlfwLibrary>> shared();
    ~GlfwLibrary();
    GlfwLibrary(const GlfwLibrary&) = delete;
    GlfwLibrary& operator=(const GlfwLibrary&) = delete;

private:
    GlfwLibrary() = default;
};

// What GLFW says of the call that failed last.
std::string whyGlfwFailed();

}  // namespace fantascope::drivers
