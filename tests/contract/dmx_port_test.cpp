#include "contract/dmx_port_suite.h"
#include "contract/simulated_rig.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace fantascope::contract {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class SimulatedDmxPortRig final : public SimulatedRig<DmxPortRig> {
public:
    explicit SimulatedDmxPortRig(Wrap<DmxPort> wrap = {}) : SimulatedRig("universe 1", std::move(wrap)) { reopen(); }

    std::optional<DmxFrame> line() override {
        if (!world_.plugged("universe 1")) return std::nullopt;
        return world_.slots(1);
    }
    std::optional<DmxFrame> lastFrame() override { return world_.slots(1); }

private:
    std::unique_ptr<DmxPort> open() override { return drivers::openDmxPort(options_, 1, context_).value(); }
};

template <class Broken>
std::vector<std::string> brokenBy() {
    return clausesOf(
        violations(dmxPortSuite(), [] { return std::make_unique<SimulatedDmxPortRig>(wrappedIn<Broken, DmxPort>); }));
}

TEST(DmxPortContract, is_kept_by_the_simulated_port) {
    EXPECT_THAT(violations(dmxPortSuite(), [] { return std::make_unique<SimulatedDmxPortRig>(); }), IsEmpty());
}

// The suite must find a port that breaks a promise, and name the promise.
class KeepsTheUnsentFrame : public Between<DmxPort> {
    using Between::Between;
    Result<void> send(std::span<const std::uint8_t, kDmxSlots> slots) override {
        if (std::exchange(last_, context_.clock.now()) == context_.clock.now()) return {};  // still busy with the previous frame
        return good_->send(slots);
    }
    Time last_{-1};
};
TEST(DmxPortContract, finds_a_port_that_keeps_an_unsent_frame) {
    EXPECT_THAT(brokenBy<KeepsTheUnsentFrame>(), ElementsAre("a newer frame replaces an unsent one"));
}

class ClosesWithAnOlderFrame : public Between<DmxPort> {
    using Between::Between;

public:
    ~ClosesWithAnOlderFrame() override {
        if (before_) (void)good_->send(*before_);
    }
    Result<void> send(std::span<const std::uint8_t, kDmxSlots> slots) override {
        before_ = std::exchange(last_, DmxFrame{});
        std::ranges::copy(slots, last_->begin());
        return good_->send(slots);
    }

private:
    std::optional<DmxFrame> before_, last_;
};
TEST(DmxPortContract, finds_a_port_that_closes_before_its_newest_frame_is_out) {
    EXPECT_THAT(brokenBy<ClosesWithAnOlderFrame>(), ElementsAre("the newest frame goes out before the port closes"));
}

class HidesItsLoss : public Between<DmxPort> {
    using Between::Between;
    Result<void> send(std::span<const std::uint8_t, kDmxSlots> slots) override {
        (void)good_->send(slots);
        return {};
    }
};
TEST(DmxPortContract, finds_a_port_that_hides_its_loss) {
    EXPECT_THAT(brokenBy<HidesItsLoss>(), ElementsAre("sending on a lost line is an error that says why"));
}

class SendsOldFramesAfterItsReturn : public Between<DmxPort> {
    using Between::Between;
    Result<void> send(std::span<const std::uint8_t, kDmxSlots> slots) override {
        if (!running()) std::copy(slots.begin(), slots.end(), kept_.emplace().begin());
        return good_->send(slots);
    }
    DeviceStatus status() const override {
        if (running() && kept_) (void)good_->send(*std::exchange(kept_, {}));
        return good_->status();
    }
    mutable std::optional<DmxFrame> kept_;
};
TEST(DmxPortContract, finds_a_port_that_sends_old_frames_after_its_return) {
    EXPECT_THAT(brokenBy<SendsOldFramesAfterItsReturn>(), ElementsAre("a frame that was sent while lost never comes out"));
}

class ShiftsItsSlots : public Between<DmxPort> {
    using Between::Between;
    Result<void> send(std::span<const std::uint8_t, kDmxSlots> slots) override {
        DmxFrame shifted{};
        std::copy(slots.begin(), slots.end() - 1, shifted.begin() + 1);
        return good_->send(shifted);
    }
};
// It never works, so whatever uses it complains.
TEST(DmxPortContract, finds_a_port_that_takes_slot_1_for_slot_0) {
    EXPECT_THAT(brokenBy<ShiftsItsSlots>(), testing::Contains("the line carries all 512 slots of the frame that was sent"));
}

// The clauses that all devices share, shown by a device that misreports its status.
class MisreportsItself : public Between<DmxPort> {
    using Between::Between;
    Result<void> send(std::span<const std::uint8_t, kDmxSlots> slots) override { return good_->send(slots); }
};

class StaysAway : public MisreportsItself {
    using MisreportsItself::MisreportsItself;
    DeviceStatus status() const override {
        DeviceStatus status = good_->status();
        if (status.losses > 0) {
            status.state = DeviceState::Faulted;
            status.detail = "restart the program";
        }
        return status;
    }
};
TEST(DeviceContract, finds_a_device_that_does_not_come_back) {
    EXPECT_THAT(brokenBy<StaysAway>(), ElementsAre("a lost device comes back by itself and the same object serves"));
}

class CountsItsAbsence : public MisreportsItself {
    using MisreportsItself::MisreportsItself;
    DeviceStatus status() const override {
        DeviceStatus status = good_->status();
        wasAbsent_ = wasAbsent_ || status.state == DeviceState::Absent;
        if (status.losses == 0 && wasAbsent_) status.losses = 1;
        return status;
    }
    mutable bool wasAbsent_ = false;
};
TEST(DeviceContract, finds_a_device_that_counts_an_absence_as_a_loss) {
    EXPECT_THAT(brokenBy<CountsItsAbsence>(),
                ElementsAre("a device that is missing at the start opens all the same and serves once it is there"));
}

class ForgetsItsLosses : public MisreportsItself {
    using MisreportsItself::MisreportsItself;
    DeviceStatus status() const override {
        DeviceStatus status = good_->status();
        status.losses = std::min(status.losses, 1);
        return status;
    }
};
TEST(DeviceContract, finds_a_device_that_loses_count) {
    EXPECT_THAT(brokenBy<ForgetsItsLosses>(), ElementsAre("every loss is counted once"));
}

}  // namespace
}  // namespace fantascope::contract
