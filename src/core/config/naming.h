#pragma once

#include "core/result.h"

#include <filesystem>

namespace fantascope {

// Adds to an error about the file `named` the place and key of `file` that name it:
// "shows/rabbit.cast.yaml:3:9: target: rabbit.png: cannot be read: No such file or directory".
// Unchanged if no such key is found.
Error namedIn(const std::filesystem::path& file, const std::filesystem::path& named, const Error& cause);

}  // namespace fantascope
