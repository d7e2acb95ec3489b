#include "contract/x_server.h"

#include "core/check.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

namespace fantascope {
namespace {

using Connection = std::unique_ptr<Display, int (*)(Display*)>;

Connection connectionTo(const std::string& name) {
    Connection connection(XOpenDisplay(name.c_str()), XCloseDisplay);
    FANTASCOPE_CHECK(connection != nullptr, "the X server is gone");
    return connection;
}

// Without a window manager every window hangs from the root. 0: there is none.
Window windowTitled(Display* display, const std::string& title) {
    Window root = 0, parent = 0, *children = nullptr, found = 0;
    unsigned count = 0;
    XQueryTree(display, DefaultRootWindow(display), &root, &parent, &children, &count);
    for (unsigned i = 0; i < count; ++i) {
        char* name = nullptr;
        if (XFetchName(display, children[i], &name) == 0) continue;
        if (title == name) found = children[i];
        XFree(name);
    }
    if (children != nullptr) XFree(children);
    return found;
}

}  // namespace

Result<std::unique_ptr<XServer>> XServer::start() {
    int ends[2];
    FANTASCOPE_CHECK(::pipe(ends) == 0, "no pipe");
    const std::string numberTo = std::to_string(ends[1]);
    const pid_t child = ::fork();
    FANTASCOPE_CHECK(child >= 0, "no process");
    if (child == 0) {
        ::prctl(PR_SET_PDEATHSIG, SIGTERM);  // a test that crashes leaves no server behind
        ::close(ends[0]);
        ::dup2(::open("/dev/null", O_WRONLY), STDERR_FILENO);
        ::execlp("Xvfb", "Xvfb", "-displayfd", numberTo.c_str(), "-screen", "0", "1280x720x24", "-nolisten", "tcp",
                 static_cast<char*>(nullptr));
        ::_exit(127);
    }
    ::close(ends[1]);
    // The server writes its number and a line's end once it can be used; if it ends before, so does the pipe.
    std::string number;
    char letter = 0;
    while (::read(ends[0], &letter, 1) == 1 && letter != '\n') number += letter;
    ::close(ends[0]);
    if (letter == '\n') return std::unique_ptr<XServer>(new XServer(child, ":" + number));
    ::kill(child, SIGTERM);
    ::waitpid(child, nullptr, 0);
    return Error("Xvfb does not start; install Debian's package xvfb: apt-get install xvfb");
}

XServer::XServer(pid_t child, const std::string& display) : child_(child), display_(display) {
    if (const char* before = std::getenv("DISPLAY")) displayBefore_ = before;
    ::setenv("DISPLAY", display_.c_str(), 1);
}

XServer::~XServer() {
    if (displayBefore_)
        ::setenv("DISPLAY", displayBefore_->c_str(), 1);
    else
        ::unsetenv("DISPLAY");
    ::kill(child_, SIGTERM);
    ::waitpid(child_, nullptr, 0);
}

std::vector<std::array<std::uint8_t, 3>> XServer::row(int y) const {
    const Connection connection = connectionTo(display_);
    XImage* const image = XGetImage(connection.get(), DefaultRootWindow(connection.get()), 0, y, 1280, 1, AllPlanes, ZPixmap);
    FANTASCOPE_CHECK(image != nullptr, "no such row");
    std::vector<std::array<std::uint8_t, 3>> pixels;
    for (int x = 0; x < image->width; ++x) {
        const unsigned long rgb = XGetPixel(image, x, 0);  // 8 bits each at depth 24
        pixels.push_back(
            {static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8), static_cast<std::uint8_t>(rgb)});
    }
    XDestroyImage(image);
    return pixels;
}

bool XServer::hasWindow(const std::string& title) const {
    const Connection connection = connectionTo(display_);
    const Window window = windowTitled(connection.get(), title);
    XWindowAttributes attributes{};
    return window != 0 && XGetWindowAttributes(connection.get(), window, &attributes) != 0 && attributes.map_state == IsViewable;
}

void XServer::pressKey(const std::string& title, const std::string& key) const {
    const Connection connection = connectionTo(display_);
    XEvent event{};
    event.xkey.type = KeyPress;
    event.xkey.display = connection.get();
    event.xkey.window = windowTitled(connection.get(), title);
    event.xkey.root = DefaultRootWindow(connection.get());
    event.xkey.same_screen = True;
    event.xkey.time = CurrentTime;
    event.xkey.keycode = XKeysymToKeycode(connection.get(), XStringToKeysym(key.c_str()));
    XSendEvent(connection.get(), event.xkey.window, True, KeyPressMask, &event);
    XSync(connection.get(), False);
}

void XServer::closeWindow(const std::string& title) const {
    const Connection connection = connectionTo(display_);
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = windowTitled(connection.get(), title);
    event.xclient.message_type = XInternAtom(connection.get(), "WM_PROTOCOLS", False);
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(XInternAtom(connection.get(), "WM_DELETE_WINDOW", False));
    XSendEvent(connection.get(), event.xclient.window, False, NoEventMask, &event);
    XSync(connection.get(), False);
}

}  // namespace fantascope
