#pragma once

#include "show/play/input.h"
#include "show/play/input_log.h"

#include "core/appended_file.h"
#include "core/result.h"

#include <filesystem>
#include <utility>
#include <vector>

namespace fantascope::show {

// Writes the inputs of a log to a file as they come, so that they can be replayed after the program
// or the machine has died:
//   fantascope-inputs 1
//   12500000000 go 0 terminal 0        as lineOf() writes it
// The file also holds the inputs that were ignored. Thread: bound to one thread, which may wait for
// the disk. The log's producers never wait.
class InputJournal {
public:
    // `log` outlives the journal. The file must not exist: an older journal may be all that is left
    // of a night. Error: names the file and the reason.
    static Result<InputJournal> create(const std::filesystem::path& file, const InputLog& log);

    // Writes the inputs that have come since the last call, and waits until they are on the disk.
    // Error: names the file and the reason. The next call continues where this one stopped.
    Result<void> write();

private:
    InputJournal(AppendedFile file, const InputLog& log) : file_(std::move(file)), inputs_(log.reader()) {}

    AppendedFile file_;
    InputLog::Reader inputs_;
};

// The inputs of a journal, oldest first. Submitted to a new log in this order, they give the same
// show. A crash may leave a last line without a line end; that line is left out. Error: names the
// file, the line and what is wrong with it.
Result<std::vector<Input>> readJournal(const std::filesystem::path& file);

}  // namespace fantascope::show
