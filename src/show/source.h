#pragma once

#include "show/source_id.h"
#include "show/source_kinds.h"

#include "core/config/config.h"
#include "core/config/file_place.h"
#include "core/fit.h"
#include "core/result.h"

#include <filesystem>
#include <string>
#include <vector>

namespace fantascope::show {

// Where a layer's picture comes from. Its files exist, but they have not been opened.
struct Source {
    std::string name;
    SourceId id;
    SourceKind picture;
    FilePlace at;  // for errors about its files' contents
    Fit fit = Fit::Contain;
};

// One entry of a show's `sources`. Strict; the files that it names must exist. Error: place, key,
// advice.
Result<Source> readSource(const std::string& name, SourceId id, const ConfigNode& node);

// The files that a source names and that can be checked alone: patterns, images, videos, casts.
std::vector<std::filesystem::path> filesOf(const Source& source);

}  // namespace fantascope::show
