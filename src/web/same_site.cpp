#include "web/same_site.h"

#include <algorithm>
#include <iterator>
#include <string_view>

namespace fantascope::web {

bool isForThisMachine(const Request& request) {
    constexpr std::string_view kNames[] = {"localhost", "127.0.0.1", "[::1]"};
    std::string_view name = request.host;
    const std::size_t colon = name.rfind(':');
    if (colon != std::string_view::npos && !name.ends_with(']')) name = name.substr(0, colon);
    return request.isLocal && std::ranges::find(kNames, name) != std::end(kNames);
}

bool isFromOwnPage(const Request& request) {
    const bool isOwn = request.origin.empty() || request.origin == "http://" + request.host;
    return isOwn && (request.fetchSite.empty() || request.fetchSite == "same-origin" || request.fetchSite == "none");
}

}  // namespace fantascope::web
