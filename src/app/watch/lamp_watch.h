#pragma once

#include "app/watch/shown_lately.h"
#include "app/watch/trim_loop.h"

#include "show/play/event.h"
#include "show/play/input_log.h"
#include "show/show_state.h"
#include "show/site/site.h"
#include "vision/watch/ambient_light.h"
#include "vision/watch/wall_watch.h"

#include "core/clock.h"

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace fantascope::app {

// What was known of the other light on the pictures at a moment, as shares of the projectors' full
// light.
struct LampReport {
    Time at{};           // show time
    double excess = 0;   // all other light, beside what is usual with the lamps that the cue asks for
    double ambient = 0;  // the ambient light in it
    show::LampTrim trim{};
};

// Watches the other light on the pictures, and trims the site's own lamps so that it stays as it
// was in the first seconds: TrimLoop decides. Lamps that a cue changes are no ambient light. A trim
// is an input like a press of GO. While it cannot be told what the light is, the trim stays; after
// three minutes of that the lamps go back to what the cue asks. The same while a desk sends on a
// universe with fixtures, since their levels are not known then. Times are show time. Thread:
// thread-bound.
class LampWatch {
public:
    // All arguments outlive this. The site lists lamps that may be trimmed.
    LampWatch(const show::Site& site, show::InputLog& inputs, show::EventLog& events);

    // Notes what is shown, with each picture of the camera.
    void note(const show::ShowState& shown);
    // Corrects a measurement of how much other light there is beside the usual, since a trim is no
    // cue.
    void explain(vision::WallLight& light, Time exposed) const;
    // Takes a measurement. `isClear`: nothing is wrong with all pictures but ambient light.
    void see(const vision::WallLight& light, bool isClear, Time exposed, Time now);
    void tick(Time now);

    // One a measurement.
    const std::vector<LampReport>& series() const { return series_; }

private:
    // Something that gives light in proportion to a level.
    struct Lamp {
        std::optional<std::size_t> intensity, colour;  // of Look::levels; the level is their product
        std::optional<std::size_t> relay;              // of Look::relays
        bool isDimmed = false;                         // by a trim
        std::optional<int> offFrom;                    // a trim with more relays off switches it off
    };
    struct Moment {
        std::vector<float> asked;  // by lamp
        show::LampTrim trim;
    };
    static std::vector<Lamp> lampsOf(const show::Site& site);
    std::vector<float> given(const Moment& moment) const;
    bool isSteady(Time exposed) const;
    void listen();
    TrimSight sightAt(const Moment& then, Time exposed, Time now) const;
    template <class Light>
    vision::AmbientLight::Light meanOf(const Light& lightOf) const;
    vision::AmbientLight::Light lightOf(const std::vector<float>& levels) const;
    vision::AmbientLight::Light ambient() const;
    void advise(const TrimSight& sight, Time now);
    void want(const show::LampTrim& trim, const std::string& why, Time now);
    void tell(const show::LampTrim& trim, const std::string& why, Time now);

    const show::Site& site_;
    const show::Corrections::Lamps& settings_;
    show::InputLog& inputs_;
    show::EventLog& events_;
    show::EventLog::Reader reader_;
    const std::vector<Lamp> lamps_;
    std::vector<vision::AmbientLight> light_;  // by output
    std::vector<double> total_;                // by output: all other light, at the last measurement
    ShownLately<Moment> moments_;
    std::vector<float> otherLevels_;           // of the channels that are no lamp's, as shown last
    std::vector<std::uint8_t> relays_;         // as shown last, with the trim
    std::optional<Time> switched_, measured_;  // a relay of the trim's; the last measurement that counts
    std::set<int> foreign_;                    // universes that a desk sends, too
    bool corrects_ = true, isDark_ = false, isAdvised_ = false;
    TrimLoop loop_;
    show::LampTrim goal_, told_;
    std::vector<LampReport> series_;
};

}  // namespace fantascope::app
