#pragma once
// The default show on the simulated default site, its devices open, on a clock that stands still:
// what the tests of a run's parts need.

#include "app/parts/fault_log.h"
#include "app/site/devices.h"
#include "drivers/site/world.h"

#include "show/play/event.h"
#include "show/play/input_log.h"
#include "show/played_show.h"
#include "show/show.h"
#include "show/site/site.h"

#include "core/check.h"
#include "core/clock.h"
#include "source_folder.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {

template <class T>
T valueOf(Result<T> result) {
    FANTASCOPE_CHECK(result.has_value(), result.error().message());
    return std::move(result).value();
}

// What a person at the terminal has been told of a run's events.
inline std::vector<std::string> toldOf(const show::EventLog& events) {
    std::vector<std::string> told;
    show::EventLog::Reader reader = events.reader();
    while (const show::Event* const event = reader.next())
        if (const std::string sentence = show::sentenceOf(*event); !sentence.empty()) told.push_back(sentence);
    return told;
}

struct RunningShow {
    show::Site site = valueOf(show::readSite(sourceFolder() + "/config/simulated/site.yaml"));
    show::Show show = valueOf(show::Show::load(sourceFolder() + "/shows/light-movement"));
    show::CueList cues = valueOf(show.bind(site));
    show::PlayedShow played{std::make_shared<const show::Revision>(show::Revision{show, site, cues, {}})};
    show::InputLog inputs{cues};
    show::EventLog events;
    FaultLog faults{events};
    ManualClock clock;
    site::World world{clock};
    Devices devices = valueOf(openDevices(site, Backends::SimulatedHeadless, {clock, &world}));

    std::vector<std::string> told() const { return toldOf(events); }
    show::Input jumpTo(std::string_view cue) const {
        return {clock.now(), show::Input::Kind::Jump, static_cast<int>(valueOf(show.cueNamed(cue)))};
    }
    int buttonOf(show::Button wanted) const {
        for (const show::SiteButton& button : site.buttons)
            if (button.button == wanted) return button.number;
        FANTASCOPE_CHECK(false, "the default site has all buttons");
    }
};

}  // namespace fantascope::app
