#include "contract/relay_bank_suite.h"
#include "contract/simulated_rig.h"

#include <gmock/gmock.h>

namespace fantascope::contract {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class SimulatedRelayBankRig final : public SimulatedRig<RelayBankRig> {
public:
    explicit SimulatedRelayBankRig(Wrap<RelayBank> wrap = {}) : SimulatedRig("relay bank", std::move(wrap)) { reopen(); }

    std::vector<bool> relays() override { return world_.relays(); }
    void handSwitches(const std::vector<bool>& states) override { world_.setRelays(states); }
    void close() override { port_.reset(); }

private:
    std::unique_ptr<RelayBank> open() override { return drivers::openRelayBank(options_, kSafe, around_).value(); }
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
    EXPECT_THAT(brokenBy<WritesAgainByItself>(), ElementsAre("after its return the bank stays safe until it is written again"));
}

class LeavesTheLightsAsTheyAre : public AlmostGood {
public:
    using AlmostGood::AlmostGood;
    ~LeavesTheLightsAsTheyAre() override {
        const std::vector<bool> last = around_.world->relays();
        good_.reset();
        around_.world->setRelays(last);
    }
};
TEST(RelayBankContract, finds_a_bank_that_leaves_the_lights_as_they_are) {
    EXPECT_THAT(brokenBy<LeavesTheLightsAsTheyAre>(), ElementsAre("closing leaves the relays safe"));
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
