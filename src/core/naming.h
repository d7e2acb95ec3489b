#pragma once

#include "core/result.h"

#include <filesystem>

namespace fantascope {

// The error of a file that another one names, led by the place and the key where it does:
// "shows/rabbit.cast.yaml:3:9: target: rabbit.png: cannot be read: No such file or directory". As
// it is where no key is found.
Error namedIn(const std::filesystem::path& file, const std::filesystem::path& named, const Error& cause);

}  // namespace fantascope
