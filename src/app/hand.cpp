#include "app/hand.h"

#include "core/log.h"

#include <fmt/format.h>

namespace fantascope::app {

Hand::Hand(const show::Show& show, const show::CueList& cues, const show::Site& site, CueController* controller, Time start)
    : show_(show), controller_(controller), start_(start), buttons_(site.buttons), playback_(cues) {
    entered_.reserve(show.cues.size());
}

void Hand::give(const show::Input& input) {
    const show::Outcome outcome = playback_.apply(input);
    for (PlaybackReplica* replica : replicas_)
        if (!replica->give(input)) log::error("app", "an input was lost: a part of the show has stopped taking them");
    if (outcome != show::Outcome::Taken) tell(std::string(show::nameOf(outcome)));
}

void Hand::tick(Time moment) {
    while (controller_ != nullptr) {
        const auto event = controller_->poll();
        if (!event) break;
        if (const auto input = buttons_.inputFor(event->button, event->pressed, event->at - start_)) give(*input);
    }
    playback_.stateAt(moment - start_, state_);
    if (state_.cue == cue_) return;
    cue_ = state_.cue;
    const std::string& name = show_.cues[static_cast<std::size_t>(cue_)].name;
    entered_.push_back({name, moment - start_});
    tell(fmt::format("cue {} of {}: {}", cue_ + 1, show_.cues.size(), name));
}

bool GoSchedule::due(Time showTime) {
    if (ended()) return false;
    constexpr double kDarkness = 1.0 / 6;  // of a cue's share
    const double share = seconds(length_) / (static_cast<double>(presses_) + (cueIsOn_ ? 1 : 0));
    if (showTime < fromSeconds(share * (static_cast<double>(pressed_) + (cueIsOn_ ? 1 : kDarkness)))) return false;
    ++pressed_;
    return true;
}

}  // namespace fantascope::app
