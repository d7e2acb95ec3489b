#include "contract/relay_bank_suite.h"
#include "contract/simulated_rig.h"

#include <gmock/gmock.h>

#include <mutex>
#include <utility>

namespace fantascope::contract {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class SimulatedRelayBankRig final : public SimulatedRig<RelayBankRig> {
public:
    explicit SimulatedRelayBankRig(Wrap<RelayBank> wrap = {}) : SimulatedRig("road", std::move(wrap)) { reopen(); }

    std::vector<bool> relays() override { return world_.relays("road"); }
    void handSwitches(const std::vector<bool>& states) override { world_.switchRelaysByHand("road", states); }
    void close() override { port_.reset(); }

private:
    std::unique_ptr<RelayBank> open() override { return drivers::openRelayBank(options_, "road", kSafe, context_).value(); }
};

template <class Broken>
std::vector<std::string> brokenBy() {
    return clausesOf(
        violations(relayBankSuite(), [] { return std::make_unique<SimulatedRelayBankRig>(wrappedIn<Broken, RelayBank>); }));
}

TEST(RelayBankContract, is_kept_by_the_simulated_bank) {
    EXPECT_THAT(violations(relayBankSuite(), [] { return std::make_unique<SimulatedRelayBankRig>(); }), IsEmpty());
}

class AlmostGood : public Between<RelayBank> {
    using Between::Between;
    std::size_t size() const override { return good_->size(); }
    Result<void> write(const std::vector<bool>& states) override { return good_->write(states); }
    Result<std::vector<bool>> read() override { return good_->read(); }
};

class ReadsFromMemory : public AlmostGood {
    using AlmostGood::AlmostGood;
    Result<void> write(const std::vector<bool>& states) override {
        written_ = states;
        return good_->write(states);
    }
    Result<std::vector<bool>> read() override {
        TRY(good_->read());
        return written_;
    }
    std::vector<bool> written_;
};
TEST(RelayBankContract, finds_a_bank_that_reads_back_what_it_wrote) {
    EXPECT_THAT(brokenBy<ReadsFromMemory>(), ElementsAre("read() tells what the relays are now, whoever switched them"));
}

class WritesAgainByItself : public AlmostGood {
    using AlmostGood::AlmostGood;
    Result<void> write(const std::vector<bool>& states) override {
        last_ = states;
        return good_->write(states);
    }
    Result<std::vector<bool>> read() override {
        if (good_->status().losses > 0) TRY(good_->write(last_));
        return good_->read();
    }
    std::vector<bool> last_;
};
TEST(RelayBankContract, finds_a_bank_that_leaves_its_safe_states_by_itself) {
    EXPECT_THAT(brokenBy<WritesAgainByItself>(), ElementsAre("read() tells what the relays are now, whoever switched them",
                                                             "after its return the bank stays safe until it is written again"));
}

class LeavesTheLightsAsTheyAre : public AlmostGood {
public:
    using AlmostGood::AlmostGood;
    ~LeavesTheLightsAsTheyAre() override {
        const std::vector<bool> last = context_.world->relays("road");
        good_.reset();
        context_.world->setRelays("road", last);
    }
};
TEST(RelayBankContract, finds_a_bank_that_leaves_the_lights_as_they_are) {
    EXPECT_THAT(brokenBy<LeavesTheLightsAsTheyAre>(), ElementsAre("closing leaves the relays safe"));
}

// Reading the relays in the middle of a show would switch them.
class MakesSafeWhatItLookedAt : public AlmostGood {
public:
    using AlmostGood::AlmostGood;
    ~MakesSafeWhatItLookedAt() override {
        good_.reset();
        context_.world->setRelays("road", RelayBankRig::kSafe);
    }
};
TEST(RelayBankContract, finds_a_bank_that_switches_what_it_only_looked_at) {
    EXPECT_THAT(brokenBy<MakesSafeWhatItLookedAt>(), ElementsAre("closing a bank that was only looked at switches nothing"));
}

constexpr const char* kFoundOtherwise =
    "relays that are found other than written are a loss, counted once, and stay so until they are written";

// It notices only its plug.
class DoesNotLookAtItsRelays : public AlmostGood {
    using AlmostGood::AlmostGood;
    DeviceStatus status() const override {
        const std::lock_guard lock(mutex_);
        DeviceStatus status = good_->status();
        // Unplugging leaves the relays safe; any other change that the good bank noticed was made
        // by hand.
        const bool byHand = context_.world->relays("road") != RelayBankRig::kSafe;
        if (const int more = status.losses - std::exchange(seen_, status.losses); !byHand) counted_ += more;
        status.losses = counted_;
        return status;
    }
    mutable std::mutex mutex_;
    mutable int seen_ = 0, counted_ = 0;
};
TEST(RelayBankContract, finds_a_bank_that_does_not_look_at_its_relays) {
    EXPECT_THAT(brokenBy<DoesNotLookAtItsRelays>(), ElementsAre(kFoundOtherwise));
}

// Knows when a hand has switched its relays.
class FeelsTheHand : public AlmostGood {
public:
    using AlmostGood::AlmostGood;
    Result<void> write(const std::vector<bool>& states) override {
        const std::lock_guard lock(mutex_);
        last_ = states;
        return good_->write(states);
    }

protected:
    // With the mutex held. Unplugging leaves the relays safe.
    bool wasSwitched() const {
        const std::vector<bool> is = context_.world->relays("road");
        return running() && !last_.empty() && is != last_ && is != RelayBankRig::kSafe;
    }
    mutable std::mutex mutex_;
    std::vector<bool> last_;
};

// The program and a person fight over the street lamps, and nobody is told.
class SwitchesBackByItself : public FeelsTheHand {
    using FeelsTheHand::FeelsTheHand;
    DeviceStatus status() const override {
        const std::lock_guard lock(mutex_);
        if (wasSwitched()) context_.world->setRelays("road", last_);
        return good_->status();
    }
};
TEST(RelayBankContract, finds_a_bank_that_switches_back_by_itself) {
    EXPECT_THAT(brokenBy<SwitchesBackByItself>(), ElementsAre(kFoundOtherwise));
}

class CountsAtEveryLook : public FeelsTheHand {
    using FeelsTheHand::FeelsTheHand;
    DeviceStatus status() const override {
        const std::lock_guard lock(mutex_);
        DeviceStatus status = good_->status();
        if (wasSwitched()) ++looks_;
        status.losses += looks_;
        return status;
    }
    mutable int looks_ = 0;
};
TEST(RelayBankContract, finds_a_bank_that_counts_a_hand_at_every_look) {
    EXPECT_THAT(brokenBy<CountsAtEveryLook>(), ElementsAre(kFoundOtherwise));
}

class DoesNotWaitForTheAnswer : public AlmostGood {
    using AlmostGood::AlmostGood;
    Result<void> write(const std::vector<bool>& states) override {
        (void)good_->write(states);
        return {};
    }
};
TEST(RelayBankContract, finds_a_bank_that_does_not_wait_for_the_answer) {
    EXPECT_THAT(brokenBy<DoesNotWaitForTheAnswer>(), ElementsAre("write() and read() on a lost bank are errors that say why"));
}

}  // namespace
}  // namespace fantascope::contract
