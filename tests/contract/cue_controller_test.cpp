#include "contract/cue_controller_suite.h"
#include "contract/simulated_rig.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace fantascope::contract {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class SimulatedCueControllerRig final : public SimulatedRig<CueControllerRig> {
public:
    explicit SimulatedCueControllerRig(Wrap<CueController> wrap = {}) : SimulatedRig("cue controller", std::move(wrap)) {
        reopen();
    }

    void finger(int button, bool down) override { world_.press(button, down); }
    void close() override { port_.reset(); }
    ButtonLight::State shown(int button) override { return world_.light(button).state; }
    int absentButton() const override { return 0; }  // any positive number is a button

private:
    std::unique_ptr<CueController> open() override { return drivers::openCueController(options_, context_).value(); }
};

Suite<CueControllerRig> wholeSuite() { return joined(cueControllerSuite(), lampSuite()); }

// Good except for what a subclass breaks.
class BetweenControllers : public Between<CueController> {
public:
    using Between::Between;
    std::optional<ButtonEvent> poll() override { return good_->poll(); }
    void light(int button, const ButtonLight& light) override { good_->light(button, light); }
};

template <class Broken>
std::vector<std::string> brokenBy() {
    return clausesOf(
        violations(wholeSuite(), [] { return std::make_unique<SimulatedCueControllerRig>(wrappedIn<Broken, CueController>); }));
}

TEST(CueControllerContract, is_kept_by_the_simulated_controller) {
    EXPECT_THAT(violations(wholeSuite(), [] { return std::make_unique<SimulatedCueControllerRig>(); }), IsEmpty());
}

class LeavesTheButtonDown : public BetweenControllers {
    using BetweenControllers::BetweenControllers;
    std::optional<ButtonEvent> poll() override {
        auto event = good_->poll();
        return running() ? event : std::nullopt;
    }
};
TEST(CueControllerContract, finds_a_controller_whose_button_hangs_after_a_loss) {
    EXPECT_THAT(brokenBy<LeavesTheButtonDown>(), ElementsAre("a button that was down at the loss is reported up, once"));
}

class PressesAtItsReturn : public BetweenControllers {
    using BetweenControllers::BetweenControllers;
    std::optional<ButtonEvent> poll() override {
        const int losses = good_->status().losses;
        if (running() && std::exchange(seen_, losses) != losses) return ButtonEvent{1, true, context_.clock.now()};
        return good_->poll();
    }
    int seen_ = 0;
};
// Example failure: the kernel's autodetection of a keyboard looks like a GO, in the middle of the
// show.
TEST(CueControllerContract, finds_a_controller_that_presses_when_it_is_plugged_in) {
    EXPECT_THAT(brokenBy<PressesAtItsReturn>(),
                testing::Contains("unplugging and plugging in make no press, and what was pressed meanwhile stays lost"));
}

class HasNoMemory : public BetweenControllers {
    using BetweenControllers::BetweenControllers;
    std::optional<ButtonEvent> poll() override { return context_.world->takePress(); }
};
TEST(CueControllerContract, finds_a_controller_that_hands_on_whatever_the_wire_says) {
    EXPECT_THAT(brokenBy<HasNoMemory>(),
                ElementsAre("a held button's repeats are left out", "a button that was down at the loss is reported up, once",
                            "a loss that was over before anybody looked still reports the button up",
                            "unplugging and plugging in make no press, and what was pressed meanwhile stays lost"));
}

class GivesTheNewestOfManyFirst : public BetweenControllers {
    using BetweenControllers::BetweenControllers;
    std::optional<ButtonEvent> poll() override {
        while (const auto event = good_->poll()) events_.push_back(*event);
        if (events_.size() > 3) std::swap(events_.front(), events_.back());
        if (events_.empty()) return std::nullopt;
        const ButtonEvent first = events_.front();
        events_.erase(events_.begin());
        return first;
    }
    std::vector<ButtonEvent> events_;
};
TEST(CueControllerContract, finds_a_controller_that_gives_the_newest_first) {
    EXPECT_THAT(brokenBy<GivesTheNewestOfManyFirst>(), ElementsAre("events of all buttons come oldest first"));
}

class PressesWhatItLights : public BetweenControllers {
    using BetweenControllers::BetweenControllers;
    void light(int button, const ButtonLight& light) override {
        good_->light(button, light);
        lit_ = running();
    }
    std::optional<ButtonEvent> poll() override {
        return std::exchange(lit_, false) ? ButtonEvent{1, true, context_.clock.now()} : good_->poll();
    }
    bool lit_ = false;
};
// Example failure: the lamp's report comes back as if it were one of the buttons.
TEST(CueControllerContract, finds_a_controller_that_presses_what_it_lights) {
    EXPECT_THAT(brokenBy<PressesWhatItLights>(),
                ElementsAre("lights make no press and hold none back, whether there are lamps or not"));
}

class PressesWhatItLightsAnew : public BetweenControllers {
    using BetweenControllers::BetweenControllers;
    void light(int button, const ButtonLight& light) override {
        good_->light(button, light);
        reported_ = reported_ || !running();
    }
    std::optional<ButtonEvent> poll() override {
        return running() && std::exchange(reported_, false) ? ButtonEvent{1, true, context_.clock.now()} : good_->poll();
    }
    bool reported_ = false;
};
TEST(CueControllerContract, finds_a_controller_that_presses_what_it_lights_at_its_return) {
    EXPECT_THAT(brokenBy<PressesWhatItLightsAnew>(), ElementsAre("a light of a lost device makes no press at its return"));
}

class WaitsForItsLamps : public BetweenControllers {
    using BetweenControllers::BetweenControllers;
    void light(int button, const ButtonLight& light) override {
        good_->light(button, light);
        context_.clock.sleepUntil(context_.clock.now() + std::chrono::milliseconds(1));
    }
};
TEST(CueControllerContract, finds_a_controller_that_waits_for_its_lamps) {
    EXPECT_THAT(brokenBy<WaitsForItsLamps>(), ElementsAre("a light is not waited for"));
}

class ShowsTheFirst : public BetweenControllers {
    using BetweenControllers::BetweenControllers;
    void light(int button, const ButtonLight& light) override {
        if (reported_.insert(button).second) good_->light(button, light);
    }
    std::set<int> reported_;
};
TEST(CueControllerContract, finds_a_controller_that_keeps_its_first_light) {
    EXPECT_THAT(brokenBy<ShowsTheFirst>(),
                ElementsAre("each button shows the newest light that it was told, and off before",
                            "a device shows again what it was told before it was lost, and what it was told meanwhile"));
}

class LightsTheNearest : public BetweenControllers {
    using BetweenControllers::BetweenControllers;
    void light(int button, const ButtonLight& light) override { good_->light(std::max(button, 1), light); }
};
TEST(CueControllerContract, finds_a_controller_that_lights_another_button) {
    EXPECT_THAT(brokenBy<LightsTheNearest>(), ElementsAre("a light of a button that is not there is left out"));
}

// Forgets its lights at the loss, like a real device.
class ForgetsItsLamps : public BetweenControllers {
    using BetweenControllers::BetweenControllers;
    DeviceStatus status() const override {
        const DeviceStatus status = good_->status();
        if (status.losses != losses_.exchange(status.losses))
            for (const int button : {1, 2}) good_->light(button, {});
        return status;
    }
    std::optional<ButtonEvent> poll() override {
        status();
        return good_->poll();
    }
    void light(int button, const ButtonLight& light) override {
        status();
        good_->light(button, light);
    }
    mutable std::atomic<int> losses_ = 0;
};
TEST(CueControllerContract, finds_a_controller_that_is_dark_after_its_return) {
    EXPECT_THAT(brokenBy<ForgetsItsLamps>(),
                ElementsAre("a device shows again what it was told before it was lost, and what it was told meanwhile"));
}

class LightsOnlyWhatIsThere : public BetweenControllers {
    using BetweenControllers::BetweenControllers;
    void light(int button, const ButtonLight& light) override {
        if (running()) good_->light(button, light);
    }
};
TEST(CueControllerContract, finds_a_controller_that_drops_the_lights_of_a_lost_device) {
    EXPECT_THAT(brokenBy<LightsOnlyWhatIsThere>(),
                ElementsAre("a device shows again what it was told before it was lost, and what it was told meanwhile",
                            "a device that is missing at the start shows what it was told before it came"));
}

class LeavesItsLampsOn : public BetweenControllers {
public:
    using BetweenControllers::BetweenControllers;
    ~LeavesItsLampsOn() override {
        good_.reset();
        for (const auto& [button, light] : reported_) context_.world->setLight(button, light);
    }
    void light(int button, const ButtonLight& light) override {
        good_->light(button, light);
        reported_[button] = light;
    }
    std::map<int, ButtonLight> reported_;
};
TEST(CueControllerContract, finds_a_controller_that_leaves_its_lamps_on) {
    EXPECT_THAT(brokenBy<LeavesItsLampsOn>(), ElementsAre("at the end all is off"));
}

}  // namespace
}  // namespace fantascope::contract
