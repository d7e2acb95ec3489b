#pragma once

#include "drivers/common/file_handle.h"

#include "theatre/deform/silhouette_sequence.h"

#include "core/result.h"

#include <cstdint>
#include <filesystem>
#include <memory>

namespace fantascope::app {

// Writes a silhouette sequence into a folder: frame-0001.png, frame-0002.png, .. and sequence.yaml.
// Everything is first written into a folder beside it, NAME.unfinished, and finish() moves it into
// place; without finish(), nothing is left behind. A killed run leaves NAME.unfinished, which the
// next run reuses. A previous sequence is replaced; other files in the folder stay.
// Thread: thread-bound.
class SequenceFolder {
public:
    // Checks beforehand that open() can succeed. Error: the folder holds something other than a
    // sequence, cannot be written, or another run is writing it.
    static Result<void> check(const std::filesystem::path& folder);
    // Error: as check().
    static Result<std::unique_ptr<SequenceFolder>> open(const std::filesystem::path& folder);
    ~SequenceFolder();

    // Whether finish() would overwrite or remove `file`.
    static bool replaces(const std::filesystem::path& folder, const std::filesystem::path& file);

    // Where to write picture `number`, counted from 0.
    std::filesystem::path frame(std::int64_t number) const;
    // Moves everything into place. `sequence` has these pictures.
    Result<void> finish(const theatre::SilhouetteSequence& sequence);

private:
    SequenceFolder(std::filesystem::path folder, std::filesystem::path making, drivers::FileHandle lock)
        : folder_(std::move(folder)), making_(std::move(making)), lock_(std::move(lock)) {}

    std::filesystem::path folder_, making_;
    drivers::FileHandle lock_;  // on making_; the kernel releases it when the process ends
};

}  // namespace fantascope::app
