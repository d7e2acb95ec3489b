#include "contract/dmx_source_suite.h"
#include "contract/simulated_rig.h"

#include <gmock/gmock.h>

#include <deque>

namespace fantascope::contract {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class SimulatedDmxSourceRig final : public SimulatedRig<DmxSourceRig> {
public:
    explicit SimulatedDmxSourceRig(Wrap<DmxSource> wrap = {}) : SimulatedRig("desk 1", std::move(wrap)) { reopen(); }

    void deskSends(const std::string& source, int level, int priority) override {
        DmxInput frame;
        frame.slots.fill(static_cast<std::uint8_t>(level));
        frame.source = source;
        frame.priority = priority;
        world_.sendFromDesk(1, frame);
    }
    bool deskTerminates(const std::string& source) override {
        DmxInput termination;
        termination.source = source;
        termination.ended = true;
        world_.sendFromDesk(1, termination);
        return true;
    }

private:
    std::unique_ptr<DmxSource> open() override { return drivers::openDmxSource(options_, 1, context_).value(); }
};

template <class Broken>
std::vector<std::string> brokenBy() {
    return clausesOf(
        violations(dmxSourceSuite(), [] { return std::make_unique<SimulatedDmxSourceRig>(wrappedIn<Broken, DmxSource>); }));
}

TEST(DmxSourceContract, is_kept_by_the_simulated_source) {
    EXPECT_THAT(violations(dmxSourceSuite(), [] { return std::make_unique<SimulatedDmxSourceRig>(); }), IsEmpty());
}

class SortsBySender : public Between<DmxSource> {
    using Between::Between;
    std::optional<DmxInput> receive() override {
        while (const auto frame = good_->receive()) waiting_[frame->source].push_back(*frame);
        for (auto& [sender, frames] : waiting_) {
            if (frames.empty()) continue;
            const DmxInput oldest = frames.front();
            frames.pop_front();
            return oldest;
        }
        return std::nullopt;
    }
    std::map<std::string, std::deque<DmxInput>> waiting_;
};
TEST(DmxSourceContract, finds_a_source_that_serves_one_sender_before_the_other) {
    EXPECT_THAT(brokenBy<SortsBySender>(), ElementsAre("frames are given once, oldest first, whoever sent them"));
}

class KnowsNoPriority : public Between<DmxSource> {
    using Between::Between;
    std::optional<DmxInput> receive() override {
        auto frame = good_->receive();
        if (frame) frame->priority = 100;
        return frame;
    }
};
TEST(DmxSourceContract, finds_a_source_that_drops_the_priority) {
    EXPECT_THAT(brokenBy<KnowsNoPriority>(),
                ElementsAre("a frame arrives whole, with its sender, its priority and the time of its arrival"));
}

class HasOnePlaceForAll : public Between<DmxSource> {
    using Between::Between;
    std::optional<DmxInput> receive() override {
        std::deque<DmxInput> waiting;
        while (const auto frame = good_->receive()) waiting.push_back(*frame);
        if (waiting.size() < 5) {  // enough except for a loud sender
            kept_.insert(kept_.end(), waiting.begin(), waiting.end());
        } else {
            kept_ = {waiting.back()};
        }
        if (kept_.empty()) return std::nullopt;
        const DmxInput oldest = kept_.front();
        kept_.pop_front();
        return oldest;
    }
    std::deque<DmxInput> kept_;
};
TEST(DmxSourceContract, finds_a_source_where_a_loud_sender_drowns_a_quiet_one) {
    EXPECT_THAT(brokenBy<HasOnePlaceForAll>(),
                ElementsAre("of each sender at least the newest frame is kept, and in order",
                            "a termination is kept when nobody takes frames, as a sender's newest is"));
}

class IgnoresTermination : public Between<DmxSource> {
    using Between::Between;
    std::optional<DmxInput> receive() override {
        auto frame = good_->receive();
        while (frame && frame->ended) frame = good_->receive();
        return frame;
    }
};
TEST(DmxSourceContract, finds_a_source_that_ignores_a_termination) {
    EXPECT_THAT(brokenBy<IgnoresTermination>(),
                ElementsAre("a termination is given once, after the frames before it, and its sender may come back",
                            "a termination is kept when nobody takes frames, as a sender's newest is"));
}

// As E1.31 sends it three times.
class RepeatsTermination : public Between<DmxSource> {
    using Between::Between;
    std::optional<DmxInput> receive() override {
        if (repeats_ > 0 && repeats_-- > 0) return termination_;
        auto frame = good_->receive();
        if (frame && frame->ended) {
            termination_ = frame;
            repeats_ = 2;
        }
        return frame;
    }
    std::optional<DmxInput> termination_;
    int repeats_ = 0;
};
TEST(DmxSourceContract, finds_a_source_that_gives_a_termination_three_times) {
    EXPECT_THAT(brokenBy<RepeatsTermination>(),
                ElementsAre("a termination is given once, after the frames before it, and its sender may come back"));
}

class WaitsForNobody : public Between<DmxSource> {
    using Between::Between;
    std::optional<DmxInput> receive() override {
        auto frame = good_->receive();
        if (frame) frame->silence = Time::zero();
        return frame;
    }
};
TEST(DmxSourceContract, finds_a_source_that_does_not_say_how_long_a_sender_may_be_silent) {
    EXPECT_THAT(brokenBy<WaitsForNobody>(), ElementsAre("a frame says how long its sender may be silent"));
}

class RepeatsTheLastFrame : public Between<DmxSource> {
    using Between::Between;
    std::optional<DmxInput> receive() override {
        auto frame = good_->receive();
        if (!running()) return std::exchange(last_, {});
        if (frame) last_ = frame;
        return frame;
    }
    std::optional<DmxInput> last_;
};
TEST(DmxSourceContract, finds_a_source_that_covers_its_loss_with_an_old_frame) {
    EXPECT_THAT(brokenBy<RepeatsTheLastFrame>(), ElementsAre("a lost source gives nothing, and nothing old after its return"));
}

}  // namespace
}  // namespace fantascope::contract
