#include "app/export/sequence_folder.h"

#include "app/base/output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSequence = "sequence.yaml", kBegin = "frame-", kEnd = ".png";

// Whether the name is that of a sequence's picture.
bool isFrame(std::string_view name) {
    if (!name.starts_with(kBegin) || !name.ends_with(kEnd) || name.size() <= kBegin.size() + kEnd.size()) return false;
    const std::string_view number = name.substr(kBegin.size(), name.size() - kBegin.size() - kEnd.size());
    return std::all_of(number.begin(), number.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

// The folder's canonical path, without a trailing slash.
fs::path plain(const fs::path& folder) {
    const fs::path path = fs::weakly_canonical(fs::absolute(folder));
    return path.has_filename() ? path : path.parent_path();
}

// Beside the folder, so that its contents can be renamed into it.
fs::path makingOf(const fs::path& folder) {
    fs::path making = plain(folder);
    making += ".unfinished";
    return making;
}

// Locks the folder. Error: another run holds the lock.
Result<drivers::FileHandle> locked(const fs::path& making) {
    drivers::FileHandle folder(::open(making.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!folder.isOpen()) return Error(fmt::format("{}: cannot be opened: {}", making.string(), std::strerror(errno)));
    if (::flock(folder.get(), LOCK_EX | LOCK_NB) != 0)
        return Error(
            fmt::format("{}: another run is writing this sequence; wait for it, or choose another folder", making.string()));
    return folder;
}

// Whether the path still names this folder: the previous holder of the lock may have removed it.
bool isStillThere(const drivers::FileHandle& folder, const fs::path& path) {
    struct stat opened {
    }, named{};
    return ::fstat(folder.get(), &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino;
}

// Checks a folder that a killed run may have left. Error: there are other files in it.
Result<void> checkLeftover(const fs::path& making) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(making, ignored))
        if (const std::string name = entry.path().filename(); name != kSequence && !isFrame(name))
            return Error(fmt::format("{}: is needed for writing the sequence, but has another file in it: {}; move it away",
                                     making.string(), name));
    return {};
}

}  // namespace

Result<void> SequenceFolder::check(const fs::path& folder) {
    std::error_code ignored;
    const fs::path path = plain(folder);
    if (fs::exists(path, ignored)) {
        if (!fs::is_directory(path, ignored))
            return Error(fmt::format("{}: is a file, a folder is needed; choose another name", folder.string()));
        if (!fs::is_empty(path, ignored) && !fs::exists(path / kSequence, ignored))
            return Error(fmt::format("{}: has other files in it and no {}; name a folder for the sequence alone", folder.string(),
                                     kSequence));
    }
    TRY(checkWritable(path / kSequence));
    const fs::path making = makingOf(folder);
    TRY(checkWritable(making / kSequence));
    if (!fs::exists(making, ignored)) return {};
    TRY(locked(making));
    return checkLeftover(making);
}

Result<std::unique_ptr<SequenceFolder>> SequenceFolder::open(const fs::path& folder) {
    TRY(check(folder));
    const fs::path making = makingOf(folder);
    for (;;) {
        std::error_code failure;
        fs::create_directories(making, failure);
        if (failure) return Error(fmt::format("{}: the folder cannot be created: {}", making.string(), failure.message()));
        drivers::FileHandle lock = TRY(locked(making));
        if (!isStillThere(lock, making)) continue;
        TRY(checkLeftover(making));
        for (const auto& entry : fs::directory_iterator(making, failure)) fs::remove(entry.path(), failure);
        return std::unique_ptr<SequenceFolder>(new SequenceFolder(plain(folder), making, std::move(lock)));
    }
}

SequenceFolder::~SequenceFolder() {
    std::error_code ignored;
    fs::remove_all(making_, ignored);
}

bool SequenceFolder::replaces(const fs::path& folder, const fs::path& file) {
    const fs::path canonical = fs::weakly_canonical(fs::absolute(file));
    const std::string name = canonical.filename();
    return canonical.parent_path() == plain(folder) && (name == kSequence || isFrame(name));
}

fs::path SequenceFolder::frame(std::int64_t number) const { return making_ / fmt::format("{}{:04}{}", kBegin, number + 1, kEnd); }

Result<void> SequenceFolder::finish(const theatre::SilhouetteSequence& sequence) {
    TRY(theatre::writeSequence(making_ / kSequence, sequence));
    // The old sequence.yaml is removed first and the new one is put in place last: whoever finds a
    // sequence.yaml finds all of its pictures.
    std::vector<fs::path> old, made;
    std::error_code failure;
    fs::create_directories(folder_, failure);
    for (const auto& entry : fs::directory_iterator(folder_, failure))
        if (isFrame(entry.path().filename().string())) old.push_back(entry.path());
    for (const auto& entry : fs::directory_iterator(making_, failure))
        if (entry.path().filename() != kSequence) made.push_back(entry.path());
    made.push_back(making_ / kSequence);
    if (!failure) fs::remove(folder_ / kSequence, failure);
    for (const fs::path& file : old)
        if (!failure) fs::remove(file, failure);
    for (const fs::path& file : made)
        if (!failure) fs::rename(file, folder_ / file.filename(), failure);
    if (failure) return Error(fmt::format("{}: cannot be written: {}", folder_.string(), failure.message()));
    return {};
}

}  // namespace fantascope::app
