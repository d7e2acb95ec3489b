#include "drivers/cue_controller/simulated.h"

namespace fantascope::drivers {

Result<Opening<CueController>> SimulatedCueController::fromConfig(const ConfigNode& options) {
    return site::Plug::fromConfig<CueController>(options, "cue controller", LossAction::Hold,
                                                 [](site::Plug plug) { return new SimulatedCueController(std::move(plug)); });
}

SimulatedCueController::~SimulatedCueController() {
    for (const int button : told_) plug_.world().setLight(button, {});
}

void SimulatedCueController::light(int button, const ButtonLight& light) {
    told_.insert(button);
    plug_.world().setLight(button, light);
}

std::optional<ButtonEvent> SimulatedCueController::poll() {
    if (plug_.lostAgain()) lost_.merge(down_);
    if (!lost_.empty()) return ButtonEvent{lost_.extract(lost_.begin()).value(), false, plug_.world().clock().now()};
    while (const auto event = plug_.world().takePress()) {
        // A press of a button that is down is auto-repeat. A release of a button that is up belongs
        // to a press that was lost.
        const bool changes = event->pressed ? down_.insert(event->button).second : down_.erase(event->button) == 1;
        if (changes) return event;
    }
    return std::nullopt;
}

}  // namespace fantascope::drivers
