#include "app/journal/journal_keeper.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace fantascope::app {

namespace {

constexpr Time kStateEvery = std::chrono::seconds(10), kFiguresEvery = std::chrono::minutes(1);
constexpr Time kClockIsSet = std::chrono::seconds(1);  // a smaller difference is no matter

}  // namespace

JournalKeeper::JournalKeeper(NightJournal* journal, const show::PlayedShow& show, show::InputLog& inputs, show::EventLog& events)
    : journal_(journal), show_(show), inputs_(inputs), events_(events), replica_(inputs) {}

Time JournalKeeper::resume(bool timePasses) {
    if (journal_ == nullptr || !journal_->earlier()) return Time{};
    const NightJournal::Earlier& earlier = *journal_->earlier();
    const Time passed = timePasses ? std::max(Time{}, journal_->utc() - earlier.ended) : Time{};
    resumed_ = show::resume(earlier.journal, earlier.at + passed, inputs_);
    return resumed_ ? resumed_->at : Time{};
}

std::optional<Time> JournalKeeper::endedBefore() const {
    return resumed_ ? std::optional(journal_->earlier()->ended) : std::nullopt;
}

std::optional<std::size_t> JournalKeeper::cueOn() const {
    return resumed_ && resumed_->cue >= 0 ? std::optional(static_cast<std::size_t>(resumed_->cue)) : std::nullopt;
}

bool JournalKeeper::start() {
    if (journal_ == nullptr) return false;
    const bool goesOn = resumed_ && resumed_->isExact;
    journal_->begin(show::journal::Run{.at = resumed_ ? resumed_->at : Time{},
                                       .utc = journal_->utc(),
                                       .goesOn = goesOn,
                                       .list = show::hashOf(*inputs_.cues()),
                                       .show = show_.at(0).show.file.string()});
    // The journal's own lines lead to where the show goes on, or else the inputs of the resumption.
    show::InputLog::Reader reader = inputs_.reader();
    while (const show::LoggedInput* const logged = reader.next())
        if (!goesOn) journal_->write(logged->input);
    inputs_.writeTo([journal = journal_](const show::LoggedInput& logged) {
        journal->write(logged.input, logged.outcome == show::Outcome::Taken);
    });
    if (!resumed_) return false;
    const auto cue = cueOn();
    events_.append({resumed_->at, show::event::ShowResumed{.cue = cue ? show_.at(0).show.cues[*cue].name : "",
                                                           .isExact = resumed_->isExact,
                                                           .damaged = journal_->earlier()->journal.damaged}});
    return true;
}

void JournalKeeper::tick(const show::journal::Figures& now) {
    if (journal_ == nullptr) return;
    const Time showTime = now.at, began = journal_->utc() - showTime;
    if (!began_) began_ = began;
    if (std::chrono::abs(began - *began_) > kClockIsSet) {
        began_ = began;
        journal_->write(show::journal::Clock{showTime, began + showTime});
    }
    while (const show::Event* const event = told_.next()) {
        const bool isHelp = std::holds_alternative<show::event::KeysAsked>(event->what) ||
                            std::holds_alternative<show::event::StateTold>(event->what) ||
                            std::holds_alternative<show::event::NextDayTold>(event->what);
        if (std::string sentence = show::sentenceOf(*event); !sentence.empty() && !isHelp)
            journal_->write(show::journal::Told{event->at, std::move(sentence)}, false);
    }
    replica_.stateAt(showTime, state_);
    show::journal::State state{.at = written_.at, .controls = state_, .corrects = state_.corrects, .cue = written_.cue};
    state.controls.next = std::nullopt;
    for (show::ListPlace& side : state.controls.sides) side.next = std::nullopt;
    if (state.controls.cue != written_.controls.cue)
        state.cue =
            state.controls.cue < 0 ? "" : show_.at(state_.revision).show.cues[static_cast<std::size_t>(state.controls.cue)].name;
    if (state != written_ || showTime - written_.at >= kStateEvery) {
        state.at = showTime;
        written_ = std::move(state);
        journal_->write(written_);
    }
    if (!figures_ || showTime - *figures_ >= kFiguresEvery) {
        figures_ = showTime;
        journal_->write(now, false);
    }
    journal_->noteTime(showTime);
}

std::string JournalKeeper::trouble() const { return journal_ != nullptr ? journal_->trouble() : ""; }

void JournalKeeper::end(const show::journal::Figures& now, const std::string& why) {
    if (journal_ == nullptr) return;
    figures_.reset();
    tick(now);
    inputs_.writeTo({});
    journal_->write(show::journal::End{now.at, why});
}

}  // namespace fantascope::app
