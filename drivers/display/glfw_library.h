#pragma once

#include "device/screen_event.h"

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

// The process's GLFW and its one connection to the X server, as long as a window needs it. GLFW
// itself does not follow the monitors; MonitorWatch does.
//
// Xlib would end the program when the connection ends or the X server refuses a request. Here the
// first sets lost(), and the second is logged, each kind once. A lost connection stays lost: its
// holders destroy their windows, release the library, and call shared() again. Do not swap after
// the loss: Mesa's software renderer (22.3) then spins for many seconds.
// Thread: the main thread.
class GlfwLibrary {
public:
    // Error: there is no X server, or somebody still holds a lost library.
    static Result<std::shared_ptr<GlfwLibrary>> shared();
    ~GlfwLibrary();
    GlfwLibrary(const GlfwLibrary&) = delete;
    GlfwLibrary& operator=(const GlfwLibrary&) = delete;

    // Makes a window with an OpenGL 4.5 core context, which is then current. `hints`: further GLFW
    // hints, as for glfwWindowHint().
    // Error: this OpenGL is too old, or the X server refuses.
    Result<GLFWwindow*> makeWindow(const std::string& title, glm::ivec2 size,
                                   std::initializer_list<std::pair<int, int>> hints = {});
    // Handles the events of all windows. Never waits. Returns whether the connection still exists.
    bool pollEvents();
    bool lost() const { return lost_; }
    // Whether another program has destroyed this window.
    bool destroyed(GLFWwindow* window) const;

    // Whether swapping buffers waits for a monitor's refresh; measured once with the first visible
    // window.
    std::optional<bool> vsync;
    // Without a window manager, places a desktop window beside the earlier ones, in rows.
    void placeWindow(GLFWwindow* window);

private:
    struct RefusedRequest;
    GlfwLibrary() = default;

    std::atomic<bool> lost_ = false;        // set by whichever thread finds out
    std::set<unsigned long> destroyed_;     // windows, by whatever program
    std::set<std::pair<int, int>> logged_;  // errors of the X server, each with its request
    glm::ivec2 free_{0};                    // where the next window goes, pixels of the X screen
    int rowHeight_ = 0;
};

// Takes a hidden window away from the window manager, so that it is not moved, decorated or
// covered. It is black until its first picture, and the pointer is hidden over it.
void takeFromWindowManager(GLFWwindow* window);
// Shows the window above all others, its top left corner at (x, y) in pixels of the X screen. It
// does not take the keyboard focus.
void showAt(GLFWwindow* window, int x, int y);

// The key that a key callback of GLFW reports; nothing: a key that no part of the program uses.
// Letters follow the keyboard's layout, so that 'y' is where a German finds it.
std::optional<Key> pressedKey(int key, int scanCode, int modifiers);

// GLFW's reason for the last failure.
std::string whyGlfwFailed();

}  // namespace fantascope::drivers
