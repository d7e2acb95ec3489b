#pragma once

#include "web/request.h"

namespace fantascope::web {

// Whether a request is for this machine by a name that no other site can have: a page elsewhere
// whose name leads to 127.0.0.1 for a moment (DNS rebinding) sends its own name.
bool isForThisMachine(const Request& request);

// Whether a request that changes something comes from our own page, or from no page at all: a
// browser says whose page sends it (Origin, RFC 6454; Sec-Fetch-Site, W3C Fetch Metadata).
bool isFromOwnPage(const Request& request);

}  // namespace fantascope::web
