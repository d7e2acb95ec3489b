#include "drivers/display/glfw_library.h"

#include "drivers/display/lost_x_connection.h"
#include "drivers/display/x_connecting.h"

#include "core/log.h"

#define GLFW_INCLUDE_NONE
#define GLFW_EXPOSE_NATIVE_X11
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>  // brings Xlib
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace fantascope::drivers {

std::string whyGlfwFailed() {
    const char* why = nullptr;
    glfwGetError(&why);
    return why != nullptr ? why : "unknown reason";
}

namespace {

std::weak_ptr<GlfwLibrary>& instance() {
    static std::weak_ptr<GlfwLibrary> open;
    return open;
}

}  // namespace

// Replaces Xlib's own handler, which ends the program.
struct GlfwLibrary::RefusedRequest {
    static int take(Display* connection, XErrorEvent* error) {
        const auto library = instance().lock();
        if (!library) return 0;
        if (library->destroyed_.contains(error->resourceid)) return 0;  // already reported
        if (!library->logged_.emplace(error->error_code, error->request_code).second) return 0;
        std::array<char, 128> text{};
        XGetErrorText(connection, error->error_code, text.data(), static_cast<int>(text.size()));
        log::warning("display", fmt::format("the X server refuses request {} for resource {:#x}: {}", int{error->request_code},
                                            error->resourceid, text.data()));
        return 0;
    }
};

Result<std::shared_ptr<GlfwLibrary>> GlfwLibrary::shared() {
    if (auto library = instance().lock()) {
        if (library->lost()) return Error("the X server has ended");
        return library;
    }
    auto connecting = connectingToX();
    int opened = GLFW_FALSE;
    if (_XDisplay* const connection = lostDuring([](void* result) { *static_cast<int*>(result) = glfwInit(); }, &opened)) {
        std::atomic<bool> lost = false;
        surviveLoss(connection, lost);
        XCloseDisplay(connection);
        return Error("the X server has ended");
    }
    connecting.unlock();
    if (opened != GLFW_TRUE) return Error(fmt::format("{}; set DISPLAY, or start an X server", whyGlfwFailed()));
    std::shared_ptr<GlfwLibrary> library(new GlfwLibrary);
    surviveLoss(glfwGetX11Display(), library->lost_);
    XSetErrorHandler(RefusedRequest::take);
    // Otherwise GLFW would query every monitor at each change, in the middle of a frame, and fail
    // if one vanishes meanwhile.
    XRRSelectInput(glfwGetX11Display(), DefaultRootWindow(glfwGetX11Display()), 0);
    instance() = library;
    return library;
}

GlfwLibrary::~GlfwLibrary() { glfwTerminate(); }

Result<GLFWwindow*> GlfwLibrary::makeWindow(const std::string& title, glm::ivec2 size,
                                            std::initializer_list<std::pair<int, int>> hints) {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    // As in the headless display: contexts of one kind can alternate on a thread.
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
    for (const auto& [hint, value] : hints) glfwWindowHint(hint, value);
    struct Wanted {
        glm::ivec2 size;
        const char* title;
        GLFWwindow* window;
    } wanted{size, title.c_str(), nullptr};
    const auto make = [](void* data) {
        Wanted& made = *static_cast<Wanted*>(data);
        made.window = glfwCreateWindow(made.size.x, made.size.y, made.title, nullptr, nullptr);
    };
    lost_ = !pollEvents() || lostDuring(make, &wanted) != nullptr;
    XSetErrorHandler(RefusedRequest::take);  // GLFW 3.3 restores Xlib's own
    if (lost_) return Error("the X server has ended");
    GLFWwindow* const window = wanted.window;
    if (window == nullptr)
        return Error(
            fmt::format("no window with OpenGL 4.5: {}; update the graphics driver (in software: Debian's package "
                        "libgl1-mesa-dri)",
                        whyGlfwFailed()));
    destroyed_.erase(glfwGetX11Window(window));  // X reuses ids
    glfwMakeContextCurrent(window);
    return window;
}

bool GlfwLibrary::pollEvents() {
    // GLFW does not report destroyed windows.
    for (XEvent event; !lost_ && XCheckTypedEvent(glfwGetX11Display(), DestroyNotify, &event) != 0;)
        destroyed_.insert(event.xdestroywindow.window);
    if (!lost_) glfwPollEvents();
    return !lost_;
}

bool GlfwLibrary::destroyed(GLFWwindow* window) const { return destroyed_.contains(glfwGetX11Window(window)); }

void GlfwLibrary::placeWindow(GLFWwindow* window) {
    Display* const display = glfwGetX11Display();
    // A window manager owns this selection (ICCCM, section 4.3).
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

std::optional<Key> pressedKey(int key, int scanCode, int modifiers) {
    Key result;
    result.shift = (modifiers & GLFW_MOD_SHIFT) != 0;
    result.control = (modifiers & GLFW_MOD_CONTROL) != 0;
    constexpr std::pair<int, Key::Name> kNamed[] = {
        {GLFW_KEY_LEFT, Key::Name::Left},      {GLFW_KEY_RIGHT, Key::Name::Right},
        {GLFW_KEY_UP, Key::Name::Up},          {GLFW_KEY_DOWN, Key::Name::Down},
        {GLFW_KEY_TAB, Key::Name::Tab},        {GLFW_KEY_ENTER, Key::Name::Enter},
        {GLFW_KEY_KP_ENTER, Key::Name::Enter}, {GLFW_KEY_BACKSPACE, Key::Name::Backspace},
        {GLFW_KEY_ESCAPE, Key::Name::Escape}};
    for (const auto& [code, name] : kNamed)
        if (code == key) {
            result.name = name;
            return result;
        }
    if (key == GLFW_KEY_SPACE) {
        result.letter = ' ';
        return result;
    }
    const char* const written = glfwGetKeyName(key, scanCode);
    if (written == nullptr || written[0] < '!' || written[0] > '~' || written[1] != '\0') return std::nullopt;
    result.letter = static_cast<char>(std::tolower(written[0]));
    return result;
}

void takeFromWindowManager(GLFWwindow* window) {
    Display* const display = glfwGetX11Display();
    XSetWindowAttributes attributes{};
    attributes.override_redirect = True;
    attributes.background_pixel = BlackPixel(display, DefaultScreen(display));
    XChangeWindowAttributes(display, glfwGetX11Window(window), CWOverrideRedirect | CWBackPixel, &attributes);

    // GLFW cannot hide the pointer without libXcursor.
    constexpr char kNothing[] = {0};
    const Pixmap nothing = XCreateBitmapFromData(display, glfwGetX11Window(window), kNothing, 1, 1);
    XColor black{};
    const Cursor pointer = XCreatePixmapCursor(display, nothing, nothing, &black, &black, 0, 0);
    XDefineCursor(display, glfwGetX11Window(window), pointer);
    XFreeCursor(display, pointer);  // the window keeps it
    XFreePixmap(display, nothing);
}

void showAt(GLFWwindow* window, int x, int y) {
    // GLFW's own calls would wait for the X server, which is busy when monitors come.
    XMoveWindow(glfwGetX11Display(), glfwGetX11Window(window), x, y);
    XMapRaised(glfwGetX11Display(), glfwGetX11Window(window));
    XFlush(glfwGetX11Display());
}

}  // namespace fantascope::drivers
