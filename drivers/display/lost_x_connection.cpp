#include "drivers/display/lost_x_connection.h"

#include <X11/Xlib.h>
#include <X11/Xlibint.h>  // the buffer of requests; its macros come last

#include <csetjmp>
#include <utility>

namespace fantascope::drivers {
namespace {

// Where to continue after abandoned work, and the connection that was lost.
struct Work {
    std::jmp_buf abandoned;
    Display* connection = nullptr;
};
Work* running = nullptr;

// Replaces Xlib's own handler, which writes to the terminal. What follows is up to the connection's
// own handler.
int onLoss(Display* connection) {
    if (Work* const work = std::exchange(running, nullptr)) {
        work->connection = connection;
        std::longjmp(work->abandoned, 1);
    }
    return 0;
}

// If another library such as EGL used a lost connection last, Xlib leaves no room for a request,
// and writes it all the same.
void makeRoomForRequests(Display* connection) {
    constexpr int kRoom = 2048;  // bytes; Xlib's minimum (BUFSIZE)
    connection->bufptr = connection->buffer;
    connection->bufmax = connection->buffer + kRoom;
}

}  // namespace

void surviveLoss(_XDisplay* connection, bool& lost) {
    XSetIOErrorHandler(onLoss);
    XSetIOErrorExitHandler(
        connection,
        [](Display* ended, void* flag) {
            *static_cast<bool*>(flag) = true;
            makeRoomForRequests(ended);
        },
        &lost);
}

_XDisplay* lostDuring(void (*work)(void* data), void* data) {
    XSetIOErrorHandler(onLoss);
    Work now;
    running = &now;
    if (setjmp(now.abandoned) == 0) work(data);
    running = nullptr;
    return now.connection;
}

}  // namespace fantascope::drivers
