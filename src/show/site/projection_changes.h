#pragma once

#include "core/config/config_edit.h"
#include "media/projection.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace fantascope::show {

// A change of one entry of the site file.
struct SiteChange {
    ConfigPath path;
    std::optional<ConfigValue> value;  // none: erase the key
};

// The changes of the file that turn the projection `then` of the site's output number `output` into
// `now`: one for each value that differs.
std::vector<SiteChange> projectionChanges(const Projection& then, const Projection& now, std::size_t output);

}  // namespace fantascope::show
