#pragma once

#include "app/journal/night_journal.h"

#include "show/play/event.h"
#include "show/play/input_log.h"
#include "show/play/playback_replica.h"
#include "show/play/resumption.h"
#include "show/played_show.h"

#include "core/clock.h"

#include <cstddef>
#include <optional>
#include <string>

namespace fantascope::app {

// Keeps the journal of a run: lets it go on with what an earlier run of the night has left, and
// writes what comes. An input is written before anybody acts on it. Without a journal it does
// nothing.
// Thread: one at a time.
class JournalKeeper {
public:
    // All arguments outlive this. `journal`: null if nobody wants one. `inputs` has no input yet.
    JournalKeeper(NightJournal* journal, const show::PlayedShow& show, show::InputLog& inputs, show::EventLog& events);

    // Submits what an earlier run has left. Returns the show time at which this one starts.
    // `timePasses`: the show went on while no run was there.
    Time resume(bool timePasses);
    // When the earlier run ended or died, in UTC by the clock of then; nothing: the show begins.
    std::optional<Time> endedBefore() const;
    // The cue that is on then; nothing: the show begins.
    std::optional<std::size_t> cueOn() const;
    // Notes that the run starts, tells that it goes on, and writes every input from now on. Returns
    // whether it goes on with an earlier one.
    bool start();

    static constexpr double kRate = 20;  // Hz
    // Writes events, changes of the controls, the time, and now and then the figures.
    void tick(const show::journal::Figures& now);
    // NightJournal::trouble().
    std::string trouble() const;
    void end(const show::journal::Figures& now, const std::string& why);

private:
    NightJournal* const journal_;
    const show::PlayedShow& show_;
    show::InputLog& inputs_;
    show::EventLog& events_;
    show::EventLog::Reader told_ = events_.reader();
    std::optional<show::Resumption> resumed_;
    show::PlaybackReplica replica_;
    show::ShowState state_;
    show::journal::State written_;
    std::optional<Time> figures_;  // when they were written last
    std::optional<Time> began_;    // UTC of show time 0, by the journal's clock at the last tick
};

}  // namespace fantascope::app
