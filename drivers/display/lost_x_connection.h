#pragma once

#include <atomic>

struct _XDisplay;  // Xlib's Display

namespace fantascope::drivers {

// Xlib ends the program when a connection to the X server ends. These keep it alive. Thread: the
// connection's, one for all. Whoever uses the connection then finds out about its end, which may be
// a thread that an OpenGL context was lent to.

// From now on `connection` sets `lost` when it ends, and its later requests go nowhere. `lost`
// outlives it.
void surviveLoss(_XDisplay* connection, std::atomic<bool>& lost);

// Calls `work(data)`, which waits for the X server, and leaves it in the middle where a connection
// ends meanwhile: it is C code, or holds nothing that has to be destroyed. The connection that
// ended, which may be a new one; null: `work` has returned.
_XDisplay* lostDuring(void (*work)(void* data), void* data);

}  // namespace fantascope::drivers
