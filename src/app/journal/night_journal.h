#pragma once

#include "drivers/common/file_handle.h"

#include "show/play/journal.h"

#include "core/appended_file.h"
#include "core/clock.h"
#include "core/result.h"
#include "core/wall_clock.h"

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace fantascope::app {

// The journal of the present night, in a folder that also has those of earlier nights:
//   journal                  of this night
//   journal-20261127T200000  of an earlier one, by when it began (UTC); the newest hundred stay
//   clock                    the newest show time, twice, so that one of them is always whole
// write() returns once the system has the line, or after kPatience; the disk has it 100 ms later.
// So a disk that is full, slow or broken holds nothing up. Its lines are kept and tried again, and
// trouble() says so.
// Thread: any, except where a function says otherwise.
class NightJournal {
public:
    static constexpr Time kPatience = std::chrono::milliseconds(20);
    // A run that begins so long after the end of another is of another night.
    static constexpr Time kNight = std::chrono::hours(6);

    // What an earlier run of this night has left.
    struct Earlier {
        show::Journal journal;
        Time at{};     // show time when it ended or died
        Time ended{};  // UTC of that moment, by the clock of then
    };

    // Null for an empty path: nobody wants a journal. `anew`: begin another one even if an earlier
    // run could go on. `asFastAsPossible`: on a stepped clock; then it has the same bytes every
    // time, and only its end waits for the disk. `wall` outlives the journal. Error: another
    // program writes this journal. Anything else is no error, but trouble().
    static Result<std::unique_ptr<NightJournal>> open(const std::filesystem::path& folder, bool anew, bool asFastAsPossible,
                                                      const WallClock& wall);
    ~NightJournal();  // writes what is left

    const std::optional<Earlier>& earlier() const { return earlier_; }
    Time utc() const { return wall_.now().utc; }

    // Writes the line of a run's beginning. From then on the times of earlier runs do not count.
    void begin(const show::journal::Run& run);
    // `isNeeded`: to go on with the show. Only such lines are written once the journal is large.
    void write(const show::journal::Line& line, bool isNeeded = true);
    // Notes the present show time.
    void noteTime(Time showTime);
    // What is wrong with the journal, and what to do, for the operator; empty: nothing.
    std::string trouble() const;

private:
    NightJournal(std::filesystem::path folder, bool isPaced, const WallClock& wall)
        : folder_(std::move(folder)), isPaced_(isPaced), wall_(wall) {}
    void readEarlier(bool anew);
    void setAside(Time began);
    void removeOld() const;
    Result<void> openFiles(std::size_t bytes);
    std::optional<Time> newestTime() const;
    bool put(std::string line);
    void writeOn(const std::stop_token& stop);
    void syncOn(const std::stop_token& stop);
    void writeTime(Time showTime);

    const std::filesystem::path folder_;
    const bool isPaced_;
    const WallClock& wall_;
    std::optional<Earlier> earlier_;
    std::optional<AppendedFile> file_;  // belongs to the writer's thread, but for sync()
    drivers::FileHandle clockFile_;
    bool secondSlot_ = false;

    mutable std::mutex mutex_;           // of:
    std::condition_variable_any wake_;   // of the writer alone: another thread that waited here would take its wakes
    std::condition_variable_any pause_;  // of the syncer
    std::condition_variable_any done_;
    std::string pending_;
    std::size_t held_ = 0;  // bytes that the file could not take yet
    std::optional<Time> time_;
    std::uint64_t asked_ = 0, written_ = 0;  // lines
    std::uintmax_t bytes_ = 0;               // of the file
    bool hasLost_ = false;                   // since the last line
    bool isDirty_ = false;                   // something is not synced
    std::string trouble_, syncTrouble_;

    std::jthread writer_, syncer_;  // last, so that they end before the other members are destroyed
};

}  // namespace fantascope::app
