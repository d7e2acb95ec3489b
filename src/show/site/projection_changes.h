#pragma once

#include "core/config/config_edit.h"
#include "media/projection.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace fantascope::show {

// One entry of the site file that is to read otherwise.
struct SiteChange {
    ConfigPath path;
    std::optional<ConfigValue> value;  // none: the key goes
};

// What makes one projection of another in the file: each value that differs, at its place in the
// site's output number `output`.
std::vector<SiteChange> projectionChanges(const Projection& then, const Projection& now, std::size_t output);

}  // namespace fantascope::show
