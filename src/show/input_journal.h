#pragma once

#include "show/input.h"
#include "show/input_log.h"

#include "core/appended_file.h"
#include "core/result.h"

#include <filesystem>
#include <utility>
#include <vector>

namespace fantascope::show {

// Writes the inputs of a log to a file as they come, so that they can be played again after the
// program or the machine died:
//   fantascope-inputs 1
//   12500000000 go 0 terminal 0        as lineOf() writes it
// Inputs that are ignored are in it, too. Thread: bound to one thread, which may wait for the disk;
// the log's producers never do.
class InputJournal {
public:
    // `log` outlives it. The file must be new: an older journal may be all that is left of a night.
    // Error: names the file and the reason.
    static Result<InputJournal> create(const std::filesystem::path& file, const InputLog& log);

    // Writes what has come since the last call, and waits until the disk has it. Error: names the
    // file and the reason; the next call goes on where this one stopped.
    Result<void> write();

private:
    InputJournal(AppendedFile file, const InputLog& log) : file_(std::move(file)), inputs_(log.reader()) {}

    AppendedFile file_;
    InputLog::Reader inputs_;
};

// The inputs of a journal, oldest first. Submitted to a new log in this order they give the same
// show. A last line without an end is what a crash leaves, and is left out. Error: names the file,
// the line and what is wrong with it.
Result<std::vector<Input>> readJournal(const std::filesystem::path& file);

}  // namespace fantascope::show
