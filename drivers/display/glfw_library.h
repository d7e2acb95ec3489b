#pragma once

#include "core/result.h"

#include <glm/vec2.hpp>

#include <atomic>
#include <initializer_list>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>

struct GLFWwindow;

namespace fantascope::drivers {

// The process's use of GLFW and its one connection to the X server, for as long as a window needs
// it. GLFW itself does not follow the monitors: MonitorWatch does.
//
// Xlib would end the program when the connection ends or the X server refuses a request. Here the
// first is lost(), and the second is logged, each kind once. A lost connection stays lost: whoever
// holds the library destroys the windows, lets go of it, and asks for shared() again. Do not swap
// after the connection is lost: Mesa's software renderer (22.3) then counts for many seconds.
// Thread: the main thread.
class GlfwLibrary {
public:
    // Error: there is no X server, or somebody still holds a library that is lost.
    static Result<std::shared_ptr<GlfwLibrary>> shared();
    ~GlfwLibrary();
    GlfwLibrary(const GlfwLibrary&) = delete;
    GlfwLibrary& operator=(const GlfwLibrary&) = delete;

    // A window with a context of OpenGL 4.5 core, which is current afterwards. `hints`: further
    // ones of GLFW, as glfwWindowHint() takes them.
    // Error: this OpenGL is too old, or the X server refuses.
    Result<GLFWwindow*> makeWindow(const std::string& title, glm::ivec2 size,
                                   std::initializer_list<std::pair<int, int>> hints = {});
    // Takes in what happened to all windows: whether the connection is still there. Never waits.
    bool pollEvents();
    bool lost() const { return lost_; }
    // Whether another program has destroyed this window.
    bool destroyed(GLFWwindow* window) const;

    // Whether swapping buffers waits for a monitor's refresh, once the first window that was seen
    // has found it out for all.
    std::optional<bool> swapsWait;
    // Puts a window of the desktop beside those before it, in rows, if there is no window manager
    // to do it.
    void placeWindow(GLFWwindow* window);

private:
    struct RefusedRequest;
    GlfwLibrary() = default;

    std::atomic<bool> lost_ = false;        // by whichever thread finds out
    std::set<unsigned long> destroyed_;     // windows, whoever did it
    std::set<std::pair<int, int>> logged_;  // errors of the X server and the requests that they were of
    glm::ivec2 free_{0};                    // pixels of the X screen: where the next window goes
    int rowHeight_ = 0;
};

// Makes a hidden window one that no window manager moves, decorates or covers with its panels, that
// is black until its first picture, and over which no pointer is seen.
void takeFromWindowManager(GLFWwindow* window);
// Shows it above all others with its top left corner there, in pixels of the X screen; it takes no
// keys from whoever has them.
void showAt(GLFWwindow* window, int x, int y);

// What GLFW says of the call that failed last.
std::string whyGlfwFailed();

}  // namespace fantascope::drivers
