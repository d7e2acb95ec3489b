#include "drivers/display/glfw_library.h"

#define GLFW_INCLUDE_NONE
#define GLFW_EXPOSE_NATIVE_X11
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>  // brings Xlib
#include <fmt/format.h>

#include <algorithm>

namespace fantascope::drivers {

std::string whyGlfwFailed() {
    const char* why = nullptr;
    glfwGetError(&why);
    return why != nullptr ? why : "unknown reason";
}

Result<std::shared_ptr<GlfwLibrary>> GlfwLibrary::shared() {
    static std::weak_ptr<GlfwLibrary> open;
    if (auto library = open.lock()) return library;
    if (!glfwInit()) return Error(fmt::format("{}; set DISPLAY, or start an X server", whyGlfwFailed()));
    // GLFW would ask the X server for every monitor at each change, in the middle of a frame, and does not bear one that vanishes meanwhile.
    XRRSelectInput(glfwGetX11Display(), DefaultRootWindow(glfwGetX11Display()), 0);
    std::shared_ptr<GlfwLibrary> library(new GlfwLibrary);
    open = library;
    return library;
}

GlfwLibrary::~GlfwLibrary() { glfwTerminate(); }

void GlfwLibrary::placeWindow(GLFWwindow* window) {
    Display* const display = glfwGetX11Display();
    // A window manager owns the selection of its screen (ICCCM, section 4.3).
    const std::string selection = fmt::format("WM_S{}", DefaultScreen(display));
    if (XGetSelectionOwner(display, XInternAtom(display, selection.c_str(), False)) != None) return;
    glm::ivec2 size(0);
    glfwGetWindowSize(window, &size.x, &size.y);
    if (free_.x > 0 && free_.x + size.x > DisplayWidth(display, DefaultScreen(display))) {
        free_ = {0, free_.y + rowHeight_};
        rowHeight_ = 0;
    }
    glfwSetWindowPos(window, free_.x, free_.y);
    free_.x += size.x;
    rowHeight_ = std::max(rowHeight_, size.y);
}

void takeFromWindowManager(GLFWwindow* window) {
    Display* const display = glfwGetX11Display();
    XSetWindowAttributes attributes{};
    attributes.override_redirect = True;
    attributes.background_pixel = BlackPixel(display, DefaultScreen(display));
    XChangeWindowAttributes(display, glfwGetX11Window(window), CWOverrideRedirect | CWBackPixel, &attributes);

    // GLFW hides no pointer on a machine without libXcursor.
    constexpr char kNothing[] = {0};
    const Pixmap nothing = XCreateBitmapFromData(display, glfwGetX11Window(window), kNothing, 1, 1);
    XColor black{};
    const Cursor pointer = XCreatePixmapCursor(display, nothing, nothing, &black, &black, 0, 0);
    XDefineCursor(display, glfwGetX11Window(window), pointer);
    XFreeCursor(display, pointer);  // the window keeps it
    XFreePixmap(display, nothing);
}

void showAt(GLFWwindow* window, int x, int y) {
    // GLFW's own calls wait for the X server, which is busy just when monitors come.
    XMoveWindow(glfwGetX11Display(), glfwGetX11Window(window), x, y);
    XMapRaised(glfwGetX11Display(), glfwGetX11Window(window));
    XFlush(glfwGetX11Display());
}

}  // namespace fantascope::drivers
