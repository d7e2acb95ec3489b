#pragma once

#include "show/site/site.h"

#include "core/config/config_edit.h"
#include "core/result.h"
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

// Makes changes of outputs in the present text of the site file, whose outputs may have moved since
// `site` was read: they are found by their names. Error: an output is no longer there, or as
// ConfigDocument::set(); some of the changes may be made.
Result<void> applyChanges(ConfigDocument& document, const Site& site, const std::vector<SiteChange>& changes);

}  // namespace fantascope::show
