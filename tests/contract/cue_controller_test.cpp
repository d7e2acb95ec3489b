#include "contract/cue_controller_suite.h"
#include "contract/simulated_rig.h"

#include <gmock/gmock.h>

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

private:
    std::unique_ptr<CueController> open() override { return drivers::openCueController(options_, around_).value(); }
};

template <class Broken>
std::vector<std::string> brokenBy() {
    return clausesOf(violations(cueControllerSuite(),
                                [] { return std::make_unique<SimulatedCueControllerRig>(wrappedIn<Broken, CueController>); }));
}

TEST(CueControllerContract, is_kept_by_the_simulated_controller) {
    EXPECT_THAT(violations(cueControllerSuite(), [] { return std::make_unique<SimulatedCueControllerRig>(); }), IsEmpty());
}

class LeavesTheButtonDown : public Between<CueController> {
    using Between::Between;
    std::optional<ButtonEvent> poll() override {
        auto event = good_->poll();
        return running() ? event : std::nullopt;
    }
};
TEST(CueControllerContract, finds_a_controller_whose_button_hangs_after_a_loss) {
    EXPECT_THAT(brokenBy<LeavesTheButtonDown>(), ElementsAre("a button that was down at the loss is reported up, once"));
}

class PressesAtItsReturn : public Between<CueController> {
    using Between::Between;
    std::optional<ButtonEvent> poll() override {
        const int losses = good_->status().losses;
        if (running() && std::exchange(seen_, losses) != losses) return ButtonEvent{1, true, around_.clock.now()};
        return good_->poll();
    }
    int seen_ = 0;
};
// Example failure: the kernel's autodetection of a keyboard looks like a GO, in the middle of the show.
TEST(CueControllerContract, finds_a_controller_that_presses_when_it_is_plugged_in) {
    EXPECT_THAT(brokenBy<PressesAtItsReturn>(),
                testing::Contains("unplugging and plugging in make no press, and what was pressed meanwhile stays lost"));
}

class HasNoMemory : public Between<CueController> {
    using Between::Between;
    std::optional<ButtonEvent> poll() override { return around_.world->takePress(); }
};
TEST(CueControllerContract, finds_a_controller_that_hands_on_whatever_the_wire_says) {
    EXPECT_THAT(brokenBy<HasNoMemory>(),
                ElementsAre("a held button's repeats are left out", "a button that was down at the loss is reported up, once",
                            "a loss that was over before anybody looked still reports the button up",
                            "unplugging and plugging in make no press, and what was pressed meanwhile stays lost"));
}

class GivesTheNewestOfManyFirst : public Between<CueController> {
    using Between::Between;
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

}  // namespace
}  // namespace fantascope::contract
