#include "contract/x_server.h"

#include "drivers/display/x_connecting.h"

#include "core/check.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <utility>

namespace fantascope {
namespace {

using Connection = std::unique_ptr<Display, int (*)(Display*)>;

Connection connectionTo(const std::string& name) {
    const auto connecting = drivers::connectingToX();
    Connection connection(XOpenDisplay(name.c_str()), XCloseDisplay);
    FANTASCOPE_CHECK(connection != nullptr, "the X server is gone");
    return connection;
}

// While it lives, a window of another program may vanish between two requests of a connection; by
// default Xlib ends the process then. Errors of other connections go where they went before.
class VanishingWindows {
public:
    explicit VanishingWindows(Display* display) {
        display_ = display;
        before_ = XSetErrorHandler(take);
    }
    ~VanishingWindows() { XSetErrorHandler(before_); }
    VanishingWindows(const VanishingWindows&) = delete;
    VanishingWindows& operator=(const VanishingWindows&) = delete;

private:
    static int take(Display* display, XErrorEvent* error) {
        return display == display_ && error->error_code == BadWindow ? 0 : before_(display, error);
    }
    static inline Display* display_ = nullptr;
    static inline XErrorHandler before_ = nullptr;
};

std::vector<std::vector<std::array<std::uint8_t, 3>>> rowsOf(Display* display, int first, int count) {
    const int width = DisplayWidth(display, DefaultScreen(display));  // up to date, because the connection is new
    XImage* const image = XGetImage(display, DefaultRootWindow(display), 0, first, static_cast<unsigned>(width),
                                    static_cast<unsigned>(count), AllPlanes, ZPixmap);
    FANTASCOPE_CHECK(image != nullptr, "no such rows");
    std::vector<std::vector<std::array<std::uint8_t, 3>>> rows(static_cast<std::size_t>(count));
    for (int y = 0; y < count; ++y)
        for (int x = 0; x < width; ++x) {
            const unsigned long rgb = XGetPixel(image, x, y);  // 8 bits each at depth 24
            rows[static_cast<std::size_t>(y)].push_back(
                {static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8), static_cast<std::uint8_t>(rgb)});
        }
    XDestroyImage(image);
    return rows;
}

// Without a window manager every window is a child of the root. 0: there is none.
Window windowTitled(Display* display, const std::string& title) {
    const VanishingWindows vanishing(display);
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

// `type`: KeyPress or KeyRelease. `state`: the mask of the held modifiers.
void sendKey(Display* display, const std::string& title, const std::string& key, int type, unsigned state) {
    XEvent event{};
    event.xkey.type = type;
    event.xkey.display = display;
    event.xkey.window = windowTitled(display, title);
    event.xkey.root = DefaultRootWindow(display);
    event.xkey.same_screen = True;
    event.xkey.time = CurrentTime;
    event.xkey.state = state;
    event.xkey.keycode = XKeysymToKeycode(display, XStringToKeysym(key.c_str()));
    const VanishingWindows vanishing(display);  // a key may close its window before it is released
    XSendEvent(display, event.xkey.window, True, KeyPressMask, &event);
    XSync(display, False);
}

// The process of an X server with the number `display`. Error: it does not start.
Result<pid_t> launched(std::vector<std::string> command, int display) {
    int ends[2];
    FANTASCOPE_CHECK(::pipe(ends) == 0, "no pipe");
    command.insert(command.begin() + 1, fmt::format(":{}", display));
    // By default it resets when its last client leaves, and refuses clients meanwhile.
    command.insert(command.end(), {"-noreset", "-displayfd", std::to_string(ends[1])});
    std::vector<char*> words;
    for (std::string& word : command) words.push_back(word.data());
    words.push_back(nullptr);
    const pid_t child = ::fork();
    FANTASCOPE_CHECK(child >= 0, "no process");
    if (child == 0) {
        ::prctl(PR_SET_PDEATHSIG, SIGTERM);  // a crashed test leaves no server behind
        ::close(ends[0]);
        ::dup2(::open("/dev/null", O_WRONLY), STDERR_FILENO);
        ::execvp(words[0], words.data());
        ::_exit(127);
    }
    ::close(ends[1]);
    // The server writes its number and a line feed once it is usable; if it ends before, the pipe
    // ends.
    char letter = 0;
    while (::read(ends[0], &letter, 1) == 1 && letter != '\n') {
    }
    ::close(ends[0]);
    if (letter == '\n') return child;
    ::kill(child, SIGTERM);
    ::waitpid(child, nullptr, 0);
    return Error(command[0] + " does not start");
}

// Whether no other test had display `number`. It is this test's then, as long as `claim` is open.
bool claimed(int number, const drivers::FileHandle& claim) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    // An abstract name: it begins with a zero, and ends with its process.
    const std::string text = fmt::format("fantascope-test-display-{}", number);
    std::copy(text.begin(), text.end(), name.sun_path + 1);
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
    return ::bind(claim.get(), reinterpret_cast<const sockaddr*>(&name), size) == 0;
}

constexpr int kFirstDisplay = 100;  // other programs look for a free display from 0

}  // namespace

Result<std::unique_ptr<XServer>> XServer::start() {
    auto server = start({"Xvfb", "-screen", "0", "1280x720x24", "-nolisten", "tcp"});
    if (!server) return Error("Xvfb does not start; install Debian's package xvfb: apt-get install xvfb");
    return server;
}

Result<std::unique_ptr<XServer>> XServer::start(std::vector<std::string> command) {
    int refusals = 0;
    for (int display = kFirstDisplay; refusals < 3; ++display) {
        drivers::FileHandle claim(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
        if (!claimed(display, claim)) continue;
        const auto child = launched(command, display);
        if (child) return std::unique_ptr<XServer>(new XServer(std::move(command), *child, display, std::move(claim)));
        ++refusals;
    }
    return Error(command[0] + " does not start");
}

XServer::XServer(std::vector<std::string> command, pid_t child, int number, drivers::FileHandle claim)
    : command_(std::move(command)),
      child_(child),
      number_(number),
      claim_(std::move(claim)),
      display_(fmt::format(":{}", number)) {
    if (const char* before = std::getenv("DISPLAY")) displayBefore_ = before;
    ::setenv("DISPLAY", display_.c_str(), 1);
}

XServer::~XServer() {
    if (displayBefore_)
        ::setenv("DISPLAY", displayBefore_->c_str(), 1);
    else
        ::unsetenv("DISPLAY");
    if (child_ == 0) return;
    ::kill(child_, SIGTERM);
    ::waitpid(child_, nullptr, 0);
}

void XServer::crash() {
    ::kill(child_, SIGKILL);
    ::waitpid(std::exchange(child_, 0), nullptr, 0);
}

void XServer::startAgain() {
    const auto child = launched(command_, number_);
    FANTASCOPE_CHECK(child.has_value(), "the X server does not start again on " + display_);
    child_ = *child;
}

void XServer::hang() const { ::kill(child_, SIGSTOP); }
void XServer::goOn() const { ::kill(child_, SIGCONT); }

std::vector<std::array<std::uint8_t, 3>> XServer::row(int y) const {
    const Connection connection = connectionTo(display_);
    return rowsOf(connection.get(), y, 1).front();
}

std::vector<std::vector<std::array<std::uint8_t, 3>>> XServer::rows() const {
    const Connection connection = connectionTo(display_);
    return rowsOf(connection.get(), 0, DisplayHeight(connection.get(), DefaultScreen(connection.get())));
}

bool XServer::hasWindow(const std::string& title) const {
    const Connection connection = connectionTo(display_);
    const Window window = windowTitled(connection.get(), title);
    const VanishingWindows vanishing(connection.get());
    XWindowAttributes attributes{};
    return window != 0 && XGetWindowAttributes(connection.get(), window, &attributes) != 0 && attributes.map_state == IsViewable;
}

void XServer::pressKey(const std::string& title, const std::string& key) const {
    const Connection connection = connectionTo(display_);
    sendKey(connection.get(), title, key, KeyPress, 0);
}

void XServer::typeKey(const std::string& title, const std::string& key, Held held) const {
    const Connection connection = connectionTo(display_);
    const unsigned state = held == Held::Shift ? ShiftMask : held == Held::Control ? ControlMask : 0;
    for (const int type : {KeyPress, KeyRelease}) sendKey(connection.get(), title, key, type, state);
}

void XServer::movePointer(const std::string& title, int x, int y, Button button) const {
    const Connection connection = connectionTo(display_);
    XEvent event{};
    event.xmotion.type = MotionNotify;
    event.xmotion.window = windowTitled(connection.get(), title);
    event.xmotion.same_screen = True;
    event.xmotion.x = x;
    event.xmotion.y = y;
    XSendEvent(connection.get(), event.xmotion.window, True, PointerMotionMask, &event);
    if (button != Button::Untouched) {
        event.xbutton.type = button == Button::Pressed ? ButtonPress : ButtonRelease;
        event.xbutton.button = Button1;
        XSendEvent(connection.get(), event.xbutton.window, True, ButtonPressMask, &event);
    }
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

void XServer::destroyWindow(const std::string& title) const {
    const Connection connection = connectionTo(display_);
    XDestroyWindow(connection.get(), windowTitled(connection.get(), title));
    XSync(connection.get(), False);
}

void XServer::killProgramOf(const std::string& title) const {
    const Connection connection = connectionTo(display_);
    XKillClient(connection.get(), windowTitled(connection.get(), title));
    XSync(connection.get(), False);
}

}  // namespace fantascope
