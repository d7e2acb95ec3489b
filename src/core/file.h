#pragma once

#include "core/result.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace fantascope {

// What a file may have that is read into memory, in bytes: one that people write, and any other,
// such as a picture or a mesh.
constexpr std::uintmax_t kMaxTextBytes = std::uintmax_t{32} << 20, kMaxFileBytes = std::uintmax_t{512} << 20;

// The whole file. Every file that somebody names is opened by this function, or after
// checkRegular(). Error: names the file and why it cannot be read: missing, no permission, larger
// than `most` bytes, or as checkRegular() says. Nothing is read then.
Result<std::string> readFile(const std::filesystem::path& path, std::uintmax_t most = kMaxTextBytes);
// Its first `bytes`, or all of it if it has no more. Error: as readFile(), but for the size.
Result<std::string> readStart(const std::filesystem::path& path, std::size_t bytes);
// Whether `path` may be opened to read it: a pipe would be waited for without end, and a device has
// no end. Nothing at all there is no error. Error: names the path and what is there: a folder, a
// pipe, a device.
Result<void> checkRegular(const std::filesystem::path& path);

// A file that has no name until finish() gives it one. Whoever reads the path sees the old bytes or
// all of the new ones, and however the program ends before, nothing is left behind. Where the file
// system knows no nameless files (NFS, FAT) it is PATH.XXXXXX meanwhile, which only the destructor
// removes. Thread: thread-bound.
class NewFile {
public:
    // Makes missing folders. Follows a link. Error: names the file and the reason, which is also
    // that it is there and may not be written, by us or (even for root) by anybody, or that it is a
    // device.
    static Result<NewFile> open(const std::filesystem::path& path);
    ~NewFile();
    NewFile(NewFile&& other) noexcept;
    NewFile& operator=(NewFile&&) = delete;

    // To write to; its place is the writer's.
    int descriptor() const { return descriptor_; }
    // Writes all of it after what was written. Error: as refused().
    Result<void> write(std::string_view bytes);
    // Syncs it and puts it in the place of what stands there. Permissions stay those of the file
    // that stands there, owner and group too where that is allowed; or all are those of the file
    // `like`, if one is named. Error: names the file and the reason.
    Result<void> finish(const std::filesystem::path& like = {});

private:
    NewFile(std::filesystem::path path, std::filesystem::path target) : path_(std::move(path)), target_(std::move(target)) {}
    Error refused(int reason) const;
    bool giveName();  // false: errno says why

    std::filesystem::path path_, target_;  // as named; where it really is
    std::string aside_;                    // its name until finish(); empty: none
    int descriptor_ = -1;
};

// Writes a NewFile at once.
Result<void> writeFile(const std::filesystem::path& path, std::string_view bytes, const std::filesystem::path& like = {});

// `path` as a file that is read wherever it lies names it: relative to the file's folder, with
// slashes. By the names alone: a link in the folder counts as what it is called. Error: it lies
// outside the folder.
Result<std::string> relativeTo(const std::filesystem::path& file, const std::filesystem::path& path);

// By which a file's kind is told, in small letters: ".png" of "leaf.PNG"; "" if there is none.
std::string endingOf(const std::filesystem::path& path);

}  // namespace fantascope
