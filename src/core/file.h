#pragma once

#include "core/result.h"

#include <filesystem>
#include <string>
#include <string_view>

namespace fantascope {

// The whole file. Error: names the file and why it cannot be read (missing, a folder, no permission).
Result<std::string> readFile(const std::filesystem::path& path);

// Writes aside in the same folder, syncs and renames, so that whoever reads `path` sees the old bytes or all of the new ones, and a
// failure leaves nothing behind. Makes missing folders. Error: names the file and the reason.
Result<void> writeFile(const std::filesystem::path& path, std::string_view bytes);

// By which a file's kind is told, in small letters: ".png" of "leaf.PNG"; "" if there is none.
std::string endingOf(const std::filesystem::path& path);

}  // namespace fantascope
