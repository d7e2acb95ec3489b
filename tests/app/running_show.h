#pragma once
// The default show on the simulated default site, its devices open, on a clock that stands still:
// what the tests of a run's parts need.

#include "app/site/devices.h"
#include "drivers/site/world.h"

#include "show/input_log.h"
#include "show/show.h"
#include "show/site.h"

#include "core/check.h"
#include "core/clock.h"
#include "source_folder.h"

#include <utility>

namespace fantascope::app {

template <class T>
T valueOf(Result<T> result) {
    FANTASCOPE_CHECK(result.has_value(), result.error().message());
    return std::move(result).value();
}

struct RunningShow {
    show::Site site = valueOf(show::readSite(sourceFolder() + "/config/simulated/site.yaml"));
    show::Show show = valueOf(show::Show::load(sourceFolder() + "/shows/light-movement"));
    show::CueList cues = valueOf(show.bind(site));
    show::InputLog inputs{cues};
    ManualClock clock;
    site::World world{clock};
    Devices devices = valueOf(openDevices(site, Backends::SimulatedHeadless, {clock, &world}));

    show::Input jumpTo(std::string_view cue) const {
        return {clock.now(), show::Input::Kind::Jump, static_cast<int>(valueOf(show.cueNamed(cue)))};
    }
    int buttonOf(show::Button wanted) const {
        for (const auto& [number, button] : site.buttons)
            if (button == wanted) return number;
        FANTASCOPE_CHECK(false, "the default site has all buttons");
    }
};

}  // namespace fantascope::app
