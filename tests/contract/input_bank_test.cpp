#include "contract/input_bank_suite.h"
#include "contract/simulated_rig.h"

#include <gmock/gmock.h>

#include <array>
#include <set>

namespace fantascope::contract {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class SimulatedInputBankRig final : public SimulatedRig<InputBankRig> {
public:
    explicit SimulatedInputBankRig(Wrap<InputBank> wrap = {}) : SimulatedRig("doors", std::move(wrap)) { reopen(); }

    void setContact(std::size_t contact, bool closed) override { world_.setContact("doors", contact, closed); }

private:
    std::unique_ptr<InputBank> open() override { return drivers::openInputBank(options_, "doors", 3, context_).value(); }
};

template <class Broken>
std::vector<std::string> brokenBy() {
    return clausesOf(
        violations(inputBankSuite(), [] { return std::make_unique<SimulatedInputBankRig>(wrappedIn<Broken, InputBank>); }));
}

TEST(InputBankContract, is_kept_by_the_simulated_bank) {
    EXPECT_THAT(violations(inputBankSuite(), [] { return std::make_unique<SimulatedInputBankRig>(); }), IsEmpty());
}

class AlmostGood : public Between<InputBank> {
    using Between::Between;
    std::size_t size() const override { return good_->size(); }
};

class OpensAtALoss : public AlmostGood {
    using AlmostGood::AlmostGood;
    std::optional<ContactChange> poll() override {
        if (!running()) {  // reads zeros, and believes them
            if (closed_.empty()) return std::nullopt;
            return ContactChange{closed_.extract(closed_.begin()).value(), false, context_.clock.now()};
        }
        const auto change = good_->poll();
        if (change && change->closed) closed_.insert(change->contact);
        if (change && !change->closed) closed_.erase(change->contact);
        return change;
    }
    std::set<std::size_t> closed_;
};
TEST(InputBankContract, finds_a_bank_that_takes_its_loss_for_open_contacts) {
    EXPECT_THAT(brokenBy<OpensAtALoss>(), ElementsAre("a loss is no change"));
}

class ForgetsWhatItSaid : public AlmostGood {
    using AlmostGood::AlmostGood;
    std::optional<ContactChange> poll() override {
        const int losses = good_->status().losses;
        if (std::exchange(seen_, losses) != losses) said_ = {};
        if (!running()) return std::nullopt;
        for (const std::size_t contact : {2, 1, 0}) {
            const bool closed = context_.world->contact("doors", contact);
            if (std::exchange(said_[contact], closed) != closed) return ContactChange{contact, closed, context_.clock.now()};
        }
        return std::nullopt;
    }
    int seen_ = 0;
    std::array<bool, 3> said_{};
};
TEST(InputBankContract, finds_a_bank_that_starts_anew_after_a_loss) {
    EXPECT_THAT(brokenBy<ForgetsWhatItSaid>(),
                ElementsAre("what was found so at the first look was not witnessed, a movement afterwards was",
                            "a loss is no change", "after the return only what differs from the last report is reported"));
}

class ClaimsToHaveSeenIt : public AlmostGood {
    using AlmostGood::AlmostGood;
    std::optional<ContactChange> poll() override {
        auto change = good_->poll();
        if (change) change->witnessed = true;
        return change;
    }
};
// Example failure: a gate that was open when the program started triggers the cue of its opening.
TEST(InputBankContract, finds_a_bank_that_claims_to_have_seen_what_it_found) {
    EXPECT_THAT(brokenBy<ClaimsToHaveSeenIt>(),
                ElementsAre("what was found so at the first look was not witnessed, a movement afterwards was"));
}

class StaresAtOneContact : public AlmostGood {
    using AlmostGood::AlmostGood;
    std::optional<ContactChange> poll() override {
        while (const auto change = good_->poll()) {
            if (change->contact == 0) return change;
            others_.push_back(*change);
        }
        if (others_.empty()) return std::nullopt;
        const ContactChange oldest = others_.front();
        others_.erase(others_.begin());
        return oldest;
    }
    std::vector<ContactChange> others_;
};
TEST(InputBankContract, finds_a_bank_that_looks_at_the_first_contact_first) {
    EXPECT_THAT(brokenBy<StaresAtOneContact>(), ElementsAre("a restless contact does not hide another"));
}

class TakesTwoForAMove : public AlmostGood {
    using AlmostGood::AlmostGood;
    std::optional<ContactChange> poll() override {
        if (again_) return std::exchange(again_, {});
        const auto change = good_->poll();
        if (++moves_ > 5) again_ = change;
        return change;
    }
    int moves_ = 0;
    std::optional<ContactChange> again_;
};
TEST(InputBankContract, finds_a_bank_that_reports_a_move_twice) {
    EXPECT_THAT(brokenBy<TakesTwoForAMove>(), testing::Contains("changes of one contact alternate, however fast it moves"));
}

}  // namespace
}  // namespace fantascope::contract
