#pragma once

struct _XDisplay;  // Xlib's Display

namespace fantascope::drivers {

// Xlib ends the program when a connection to the X server ends; these functions prevent that.
// Thread: one thread, that of all connections.

// When `connection` ends, `lost` becomes true and later requests are discarded. `lost` outlives the
// connection.
void surviveLoss(_XDisplay* connection, bool& lost);

// Calls `work(data)`, which waits for the X server, and abandons it if a connection ends meanwhile.
// So `work` must be C code, or hold nothing that needs a destructor. Returns the connection that
// ended, which may be a new one; null: `work` has returned.
_XDisplay* lostDuring(void (*work)(void* data), void* data);

}  // namespace fantascope::drivers
