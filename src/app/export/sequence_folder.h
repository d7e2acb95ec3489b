#pragma once

#include "drivers/common/file_handle.h"

#include "theatre/deform/silhouette_sequence.h"

#include "core/result.h"

#include <cstdint>
#include <filesystem>
#include <memory>

namespace fantascope::app {

// A folder that becomes a silhouette sequence: frame-0001.png, frame-0002.png, .. and
// sequence.yaml. Everything is made in a folder beside it, NAME.unfinished, and put in place by
// finish(); without it nothing is left behind. A run that is killed leaves NAME.unfinished: the
// next one takes it over. A sequence that was there before is replaced; other files in the folder
// stay.
// Thread: thread-bound.
class SequenceFolder {
public:
    // Whether open() can. Error: the folder holds something else than a sequence, cannot be
    // written, or another run is making it.
    static Result<void> check(const std::filesystem::path& folder);
    // Error: as check().
    static Result<std::unique_ptr<SequenceFolder>> open(const std::filesystem::path& folder);
    ~SequenceFolder();

    // Whether finish() would write over, or remove, this file.
    static bool replaces(const std::filesystem::path& folder, const std::filesystem::path& file);

    // Where picture `number`, from 0, is to be written.
    std::filesystem::path frame(std::int64_t number) const;
    // `sequence` has these pictures.
    Result<void> finish(const theatre::SilhouetteSequence& sequence);

private:
    SequenceFolder(std::filesystem::path folder, std::filesystem::path making, drivers::FileHandle lock)
        : folder_(std::move(folder)), making_(std::move(making)), lock_(std::move(lock)) {}

    std::filesystem::path folder_, making_;
    drivers::FileHandle lock_;  // of making_; the kernel releases it with the process
};

}  // namespace fantascope::app
