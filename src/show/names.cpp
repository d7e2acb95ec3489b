#include "show/names.h"

#include "core/config/config.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::show {

int listNamed(std::string_view name, const std::vector<std::string>& sides) {
    if (name.empty()) return 0;
    const auto found = std::ranges::find(sides, name);
    return found == sides.end() ? -1 : static_cast<int>(found - sides.begin()) + 1;
}

Result<std::size_t> findName(std::string_view name, const std::vector<std::string>& known, std::string_view what) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found != known.end()) return static_cast<std::size_t>(found - known.begin());
    const std::string nearest = nearestName(name, known);
    const std::string advice = !nearest.empty() ? fmt::format("did you mean '{}'?", nearest)
                               : known.empty()  ? std::string("there is none at all")
                                                : fmt::format("known: {}", fmt::join(known, ", "));
    return Error(fmt::format("no {} is called '{}' ({})", what, name, advice));
}

}  // namespace fantascope::show
