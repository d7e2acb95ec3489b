#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>

namespace fantascope::app {

// Notices that files are saved. Editors write a file in several steps, or put another one in its
// place, so a file counts as saved once it has stayed the same from one look to the next. Looking
// costs two system calls for each file.
// Thread: one at a time.
class FileWatch {
public:
    // From now on these files, as they are now; those that were watched before, as they were then.
    void watch(const std::set<std::filesystem::path>& files);
    // The files that were saved since they were watched or found saved last. One that is not there
    // is not saved yet.
    std::set<std::filesystem::path> saved();

private:
    struct Stamp {
        std::filesystem::file_time_type written{};
        std::uintmax_t bytes = 0;
        bool isThere = false;
        friend bool operator==(const Stamp&, const Stamp&) = default;
    };
    static Stamp stampOf(const std::filesystem::path& file);
    struct Watched {
        Stamp known, seen;  // when it was found saved, and at the last look
    };
    std::map<std::filesystem::path, Watched> files_;
};

}  // namespace fantascope::app
