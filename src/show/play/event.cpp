#include "show/play/event.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace fantascope::show {
namespace {

std::string durationText(Time time) {
    const auto tenths = std::llround(seconds(time) * 10);
    if (tenths < 600) return fmt::format("{}.{} s", tenths / 10, tenths % 10);
    return fmt::format("{} min {:02} s", tenths / 600, tenths % 600 / 10);
}

std::string causeOf(const auto& cause) {
    return cause.output.empty() ? cause.cause : fmt::format("{}: {}", cause.output, cause.cause);
}

// "Lamps, " before news of a side list.
std::string inList(const std::string& list) { return list.empty() ? "" : list + ", "; }

struct Teller {
    std::string operator()(const event::InputDecided& decided) const {
        return decided.input.outcome == Outcome::Taken ? "" : std::string(nameOf(decided.input.outcome));
    }
    std::string operator()(const event::CueEntered& entered) const {
        if (entered.cue < 0) return inList(entered.list) + "no cue: it gets dark";
        return fmt::format("{}cue {}: {}", inList(entered.list), placeOf(entered.number, entered.cue, entered.cues),
                           entered.name);
    }
    std::string operator()(const event::HoldChanged& change) const {
        switch (change.hold) {
            case Hold::Blackout:
                return change.on ? "blackout: pictures and lamps are dark" : "light: the blackout is over";
            case Hold::Panic:
                return change.on ? "PANIC: pictures and lamps go dark, relays are safe, the cues stand still"
                                 : "restored: the show goes on from where it was";
            case Hold::Pause:
                return change.on ? "paused: the cues stand still" : "the cues go on";
            case Hold::Freeze:
                return change.on ? "frozen: what is seen stays, the cues go on unseen" : "what the cues do is seen again";
            case Hold::Lock:
                return change.on ? "locked: hand controller, contacts and windows can only make it dark"
                                 : "unlocked: hand controller, contacts and windows work";
        }
        return "";
    }
    std::string operator()(const event::MasterChanged& change) const {
        return fmt::format("master {:.0f} %", 100 * change.level);
    }
    std::string operator()(const event::LampHighlighted& highlighted) const {
        if (highlighted.lamp.empty()) return "no lamp is highlighted any more";
        const std::string level =
            highlighted.level < 1 ? fmt::format("at {:.0f} %", 100 * highlighted.level) : std::string("at full");
        return highlighted.solo ? fmt::format("solo: nothing is seen but '{}', {}", highlighted.lamp, level)
                                : fmt::format("highlight: '{}' is {}", highlighted.lamp, level);
    }
    std::string operator()(const event::LampParked& change) const {
        return change.parked ? fmt::format("parked: '{}' stays as it is", change.lamp)
                             : fmt::format("'{}' is parked no more", change.lamp);
    }
    std::string operator()(const event::LampRaised& change) const {
        return change.level > 0 ? fmt::format("by hand: '{}' at {:.0f} % at least", change.lamp, 100 * change.level)
                                : fmt::format("'{}' is as the cues have it", change.lamp);
    }
    std::string operator()(const event::RelaySwitched& change) const {
        if (!change.on) return fmt::format("relay '{}' is as the cues have it", change.relay);
        return fmt::format("by hand: relay '{}' is {} until a cue switches it", change.relay, *change.on ? "on" : "off");
    }
    std::string operator()(const event::RelayChosen& chosen) const {
        return chosen.relay.empty() ? "there is no relay" : fmt::format("{} switches relay '{}'", chosen.key, chosen.relay);
    }
    std::string operator()(const event::PageOpened& page) const { return "the page of this run is at " + page.address; }
    std::string operator()(const event::CueLoaded& loaded) const {
        if (loaded.cue < 0) return inList(loaded.list) + "GO enters the next cue";
        return fmt::format("{}GO enters cue {}: {}", inList(loaded.list), placeOf(loaded.number, loaded.cue, loaded.cues),
                           loaded.name);
    }
    std::string operator()(const event::ListChosen& chosen) const {
        return "GO, back and load are now for " + (chosen.list.empty() ? "the show's own cues" : "'" + chosen.list + "'");
    }
    std::string operator()(const event::ShowResumed& resumed) const {
        std::string text = "the show goes on where the journal ends";
        if (!resumed.isExact) text += "; the cue list has changed, so the cue begins again";
        if (resumed.damaged > 0) text += fmt::format("; {} of its lines are damaged and left out", resumed.damaged);
        return text;
    }
    std::string operator()(const event::ScheduleCalled& called) const {
        return fmt::format("schedule: {}{}", called.what, called.joins ? ", joined where the show would be" : "");
    }
    std::string operator()(const event::NextDayTold& told) const { return "the schedule, " + told.lines; }
    std::string operator()(const event::ClockSet& set) const {
        return fmt::format("the machine's clock was set {} by {:.0f} s: {}", set.by > Time{} ? "forward" : "back",
                           std::abs(seconds(set.by)), set.now);
    }
    std::string operator()(const event::ScheduleEnded&) const { return "you have the controller"; }
    std::string operator()(const event::QuitAsked& asked) const {
        return fmt::format("the show goes on; {} again within {:.0f} s ends it", asked.key, seconds(asked.patience));
    }
    std::string operator()(const event::KeysAsked& asked) const { return "the keys:\n" + asked.keys; }
    std::string operator()(const event::StateTold& told) const { return "now: " + told.lines; }
    std::string operator()(const event::FaultBegan& fault) const { return fault.what; }
    std::string operator()(const event::FaultEnded& fault) const {
        return fault.news.empty() ? "" : fmt::format("{} after {}", fault.news, durationText(fault.lasted));
    }
    std::string operator()(const event::SendersChanged& change) const {
        return change.senders.front().empty() ? sentenceOf(change) : "";
    }
    std::string operator()(const event::PictureTaken& picture) const { return "picture: " + picture.file.string(); }
    std::string operator()(const event::PictureMissed& picture) const { return "no picture: " + picture.why; }
    std::string operator()(const event::PictureMoved& moved) const {
        return fmt::format("the picture of '{}' has moved by {:.1f} px on the wall", moved.output, moved.px);
    }
    std::string operator()(const event::CameraMoved&) const {
        return "the camera has moved: nothing is corrected any more; calibrate again after the show";
    }
    std::string operator()(const event::MovementUnclear&) const {
        return "a projector or the camera has moved; the camera's view does not tell which, so nothing is corrected: look at "
               "both";
    }
    std::string operator()(const event::CauseBegan& began) const { return causeOf(began) + ": " + began.advice; }
    std::string operator()(const event::CauseEnded& ended) const { return causeOf(ended) + ": over"; }
    std::string operator()(const event::LampsTrimmed& trim) const {
        if (!trim.applied)
            return trim.why + ": the lamps could give less (corrections: lamps: {mode: automatic} in the site file)";
        if (trim.share >= 1 && trim.off.empty()) return trim.why + ": the lamps go back to what the cue asks";
        const std::string off = trim.off.empty() ? "" : fmt::format("; off: {}", fmt::join(trim.off, ", "));
        return fmt::format("{}: the lamps go to {:.0f} % of their levels{}; c takes it back", trim.why, 100 * trim.share, off);
    }
    std::string operator()(const event::LightCorrected& light) const {
        if (!light.trouble.empty()) return fmt::format("the light of '{}' is not evened out: {}", light.canvas, light.trouble);
        const std::string figures =
            fmt::format("{:.0f} % of its light {} left; {:.0f} % of its places stay darker and {:.0f} % brighter than the others",
                        100 * light.kept, light.applied ? "is" : "would be", 100 * light.tooDark, 100 * light.tooBright);
        if (light.applied) return fmt::format("the light of '{}' is evened out: {}", light.canvas, figures);
        return fmt::format("the light of '{}' could be evened out (corrections: light: {{mode: automatic}} in the site file): {}",
                           light.canvas, figures);
    }
    std::string operator()(const event::PatternFitted& fitted) const {
        const double percent = 100 * (1 - fitted.toneAfter / fitted.toneBefore);
        if (!fitted.applied)
            return fmt::format(
                "{}: the pattern would read {:.0f} % better on this wall (corrections: pattern: {{mode: automatic}})",
                fitted.source, percent);
        return fmt::format("{}: the pattern is fitted to this wall and reads {:.0f} % better: {} shapes come, {} go, {} change",
                           fitted.source, percent, fitted.made, fitted.removed, fitted.changed);
    }
    std::string operator()(const event::ShowRevised& revised) const {
        return revised.files + " was saved: the show goes on with it" + revised.news;
    }
    std::string operator()(const event::RevisionRefused& refused) const {
        return fmt::format("{} was saved, but the show goes on as it was: {}", refused.files, refused.why);
    }
    std::string operator()(const event::SiteChanged& changed) const {
        return fmt::format("{} was saved: what it says of {} counts when the show begins anew", changed.file.string(),
                           changed.later);
    }
    std::string operator()(const event::SiteAdopted& adopted) const {
        return fmt::format("{} was saved: now set up as it says: {}", adopted.file.string(), adopted.outputs);
    }
    std::string operator()(const event::SettingUpBegan&) const {
        return "setting up the outputs: the picture lists the keys, e ends it";
    }
    std::string operator()(const event::SettingUpEnded& end) const {
        return end.saved ? "the outputs are set up" : "the outputs are set up but not written to the file: e, then w";
    }
    std::string operator()(const event::SiteSaved& site) const {
        return fmt::format("{} is written; its previous version is {}", site.file.string(), site.previous.string());
    }
    std::string operator()(const event::SiteNotSaved& site) const { return "not written: " + site.why; }
};

}  // namespace

std::string sentenceOf(const event::SendersChanged& change) {
    std::string names;
    for (const std::string& sender : change.senders)
        names += (names.empty() ? "" : " and ") + (sender.empty() ? "the show" : "'" + sender + "'");
    return fmt::format("universe {} is now sent by {}", change.universe, names);
}

std::string sentenceOf(const Event& event) { return std::visit(Teller(), event.what); }

}  // namespace fantascope::show
