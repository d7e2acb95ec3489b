#pragma once

#include "core/result.h"

#include <glm/vec2.hpp>

#include <memory>
#include <optional>
#include <string>

struct GLFWwindow;

namespace fantascope::drivers {

// The process's use of GLFW, for as long as a window needs it. GLFW itself does not follow the monitors: MonitorWatch does.
// Thread: the main thread.
class GlfwLibrary {
public:
    // Error: there is no X server.
    static Result<std::shared_ptr<GlfwLibrary>> shared();
    ~GlfwLibrary();
    GlfwLibrary(const GlfwLibrary&) = delete;
    GlfwLibrary& operator=(const GlfwLibrary&) = delete;

    // Whether swapping buffers waits for a monitor's refresh, once the first window that was seen has found it out for all.
    std::optional<bool> swapsWait;
    // Puts a window of the desktop beside those before it, in rows, if there is no window manager to do it.
    void placeWindow(GLFWwindow* window);

private:
    GlfwLibrary() = default;

    glm::ivec2 free_{0};  // pixels of the X screen: where the next window goes
    int rowHeight_ = 0;
};

// Makes a hidden window one that no window manager moves, decorates or covers with its panels, that is black until its first picture, and
// over which no pointer is seen.
void takeFromWindowManager(GLFWwindow* window);
// Shows it above all others with its top left corner there, in pixels of the X screen; it takes no keys from whoever has them.
void showAt(GLFWwindow* window, int x, int y);

// What GLFW says of the call that failed last.
std::string whyGlfwFailed();

}  // namespace fantascope::drivers
