#pragma once

#include "core/result.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace fantascope {

// The whole file. Error: names the file and why it cannot be read (missing, a folder, no permission).
Result<std::string> readFile(const std::filesystem::path& path);
// Its first `bytes`, or all of it if it has no more.
Result<std::string> readStart(const std::filesystem::path& path, std::size_t bytes);

// Writes aside in the same folder, syncs and renames, so that whoever reads `path` sees the old bytes or all of the new ones, and a
// failure leaves nothing behind. Makes missing folders. Follows a link. Permissions stay those of the file that stands there, owner and group
// too where that is allowed; or all are those of the file `like`, if one is named. Error: names the file and the reason, which is also
// that it is there and may not be written: by us, or (even for root) by anybody.
Result<void> writeFile(const std::filesystem::path& path, std::string_view bytes, const std::filesystem::path& like = {});

// `path` as a file that is read wherever it lies names it: relative to the file's folder, with slashes. By the names alone: a link in the
// folder counts as what it is called. Error: it lies outside the folder.
Result<std::string> relativeTo(const std::filesystem::path& file, const std::filesystem::path& path);

// By which a file's kind is told, in small letters: ".png" of "leaf.PNG"; "" if there is none.
std::string endingOf(const std::filesystem::path& path);

}  // namespace fantascope
