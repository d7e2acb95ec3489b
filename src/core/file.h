#pragma once

#include "core/result.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace fantascope {

// The maximum size of a file that is read into memory, in bytes: one that people write, and any
// other, such as a picture or a mesh.
constexpr std::uintmax_t kMaxTextBytes = std::uintmax_t{32} << 20, kMaxFileBytes = std::uintmax_t{512} << 20;

// Reads the whole file. Every file that a user names is opened by this function, or after
// checkRegular(). Error: names the file and the reason: missing, no permission, larger than `max`
// bytes, or as checkRegular(). Then nothing is read.
Result<std::string> readFile(const std::filesystem::path& path, std::uintmax_t max = kMaxTextBytes);
// Reads its first `bytes`, or all of it if it is shorter. Error: as readFile(), without the size.
Result<std::string> readStart(const std::filesystem::path& path, std::size_t bytes);
// Checks that `path` may be opened for reading: a pipe would block forever, and a device has no
// end. A missing file is no error. Error: names the path and what it is: a folder, a pipe, a
// device.
Result<void> checkRegular(const std::filesystem::path& path);

// A new file that has no name until finish(). Readers of the path see the old bytes or all of the
// new ones; if the program ends before, nothing is left behind. If the file system has no nameless
// files (NFS, FAT), the file is PATH.XXXXXX meanwhile, which only the destructor removes. Thread:
// thread-bound.
class NewFile {
public:
    // Makes missing folders. Follows a link. Error: names the file and the reason; also if the file
    // exists and may not be written, by us or (even for root) by anybody, or is a device.
    static Result<NewFile> open(const std::filesystem::path& path);
    ~NewFile();
    NewFile(NewFile&& other) noexcept;
    NewFile& operator=(NewFile&&) = delete;

    // For writing directly; the file offset is the caller's.
    int descriptor() const { return descriptor_; }
    // Appends all bytes. Error: as refused().
    Result<void> write(std::string_view bytes);
    // Syncs the file and moves it to its path. It keeps the permissions of the file that it
    // replaces, and owner and group if allowed; or takes all of them from the file `like`. Error:
    // names the file and the reason.
    Result<void> finish(const std::filesystem::path& like = {});

private:
    NewFile(std::filesystem::path path, std::filesystem::path target) : path_(std::move(path)), target_(std::move(target)) {}
    Error refused(int reason) const;
    bool giveName();  // false: see errno

    std::filesystem::path path_, target_;  // as named; with links resolved
    std::string aside_;                    // its temporary name; empty: none
    int descriptor_ = -1;
};

// Writes a whole NewFile.
Result<void> writeFile(const std::filesystem::path& path, std::string_view bytes, const std::filesystem::path& like = {});

// Swaps two files: whenever the program ends, each has its old bytes or each has its new ones. Only
// where the file system cannot swap (NFS, FAT) an end in the middle leaves the same bytes in both.
// Follows links. Error: names the file and the reason; both stay as they were.
Result<void> exchangeFiles(const std::filesystem::path& a, const std::filesystem::path& b);

// `path` in the form that `file` can name wherever it lies: relative to the file's folder, with
// slashes. Purely by name: a link in the folder counts under its own name. Error: it lies outside
// the folder.
Result<std::string> relativeTo(const std::filesystem::path& file, const std::filesystem::path& path);

// The file's extension in lower case: ".png" for "leaf.PNG"; "" if there is none.
std::string endingOf(const std::filesystem::path& path);

}  // namespace fantascope
